"""A folder to hand on: the report, the recording, and rerun's web viewer to show it at any instant of the report."""

from wirerope_mj.views.share.pages import VIEWER as VIEWER
from wirerope_mj.views.share.pages import linked_report as linked_report
from wirerope_mj.views.share.pages import viewer_pages as viewer_pages
