from .docx import check_docx as check_docx
from .docx import write_docx as write_docx
from .pdf import write_pdf as write_pdf
