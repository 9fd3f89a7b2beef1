"""Reports: a finished run as one page that can be handed over, and as a PDF of it."""

from wirerope_mj.views.report.assemble import report_content as report_content
from wirerope_mj.views.report.content import ReportContent as ReportContent
from wirerope_mj.views.report.page import report_html as report_html
from wirerope_mj.views.report.pdf import check_pdf as check_pdf
from wirerope_mj.views.report.pdf import write_pdf as write_pdf
from wirerope_mj.views.report.run import BASE as BASE
from wirerope_mj.views.report.run import FinishedRun as FinishedRun
from wirerope_mj.views.report.run import worst_names as worst_names
