"""Draw every figure of the gallery and write its page: python docs/gallery/build.py."""

from io import BytesIO
from pathlib import Path

from figures import all_figures
from figures.page import page
from matplotlib.figure import Figure as Picture
from PIL import Image

FOLDER = Path(__file__).parent


def main() -> None:
    """Write the pictures and README.md beside this file; pictures of figures that are gone are removed."""
    figures = all_figures()
    for figure in figures:
        save(figure.draw(), FOLDER / figure.file)
        print(f"figure {figure.number}: {(FOLDER / figure.file).stat().st_size / 1e3:.0f} kB")
    for stale in {path.name for path in FOLDER.glob("figure_*.png")} - {figure.file for figure in figures}:
        (FOLDER / stale).unlink()
    (FOLDER / "README.md").write_text(page(figures), encoding="utf-8", newline="\n")


def save(picture: Picture, path: Path) -> None:
    """Write a picture with a palette of 128 colours: line drawings lose nothing, and files shrink to a third."""
    drawn = BytesIO()
    picture.savefig(drawn, format="png")
    Image.open(drawn).convert("RGB").quantize(128, dither=Image.Dither.NONE).save(path, optimize=True)


if __name__ == "__main__":
    main()
