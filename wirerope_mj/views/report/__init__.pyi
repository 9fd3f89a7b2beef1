from .docx import check_docx as check_docx
from .docx import write_docx as write_docx
from .page import report_html as report_html
from .pdf import check_pdf as check_pdf
from .pdf import write_pdf as write_pdf
