from .assemble import report_content as report_content
from .content import ReportContent as ReportContent
from .page import report_html as report_html
from .pdf import check_pdf as check_pdf
from .pdf import write_pdf as write_pdf
from .run import BASE as BASE
from .run import FinishedRun as FinishedRun
from .run import worst_names as worst_names
