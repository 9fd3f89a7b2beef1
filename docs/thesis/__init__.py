"""The pages about the thesis, chapter by chapter: `python -m docs.thesis` computes their numbers and pictures."""

import sys
from pathlib import Path

FOLDER = Path(__file__).parent
sys.path.insert(0, str(FOLDER.parent / "gallery"))  # how its pictures look is how all of them look
