from .docx import check_docx as check_docx
from .docx import write_docx as write_docx
from .page import check_pdf as check_pdf
from .page import report_html as report_html
from .page import write_pdf as write_pdf
