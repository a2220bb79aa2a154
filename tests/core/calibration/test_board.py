import numpy as np
import pytest

from core.calibration.board import DICTIONARIES, BoardSpec
from core.calibration.detection import detect_board
from core.calibration.lens import Lens
from core.calibration.printing import PAPERS_MM, draw_page, write_board_pdf
from core.errors import InputError
from core.scan.model import Intrinsics


@pytest.mark.parametrize("dictionary", DICTIONARIES)
def test_the_drawn_board_is_opencvs(dictionary):
    board = BoardSpec(dictionary=dictionary)
    cells = board.cells()
    theirs = board.cv_board().generateImage(cells.shape[::-1], marginSize=0, borderBits=1) == 0
    assert np.array_equal(cells, theirs)
    assert np.allclose(board.corners_m, board.cv_board().getChessboardCorners())


@pytest.mark.parametrize("paper", PAPERS_MM)
def test_the_printed_page_is_to_scale(paper, tmp_path):
    """The page as a scanner at 200 dpi has it: squares and bar are as long as they say."""
    dpi = 200
    board = BoardSpec()
    figure = draw_page(board, paper)
    figure.savefig(tmp_path / "page.png", dpi=dpi)
    import cv2

    image = cv2.imread(str(tmp_path / "page.png"), cv2.IMREAD_GRAYSCALE)
    found = detect_board(image, board, Lens(Intrinsics(2000, 2000, 1000, 800)))
    assert len(found.ids) == board.n_corners
    wide = found.corners_px[board.columns - 2] - found.corners_px[0]
    assert np.hypot(*wide) / dpi * 0.0254 == pytest.approx(0.030 * (board.columns - 2), abs=1e-4)
    foot = image[-round(25 / 25.4 * dpi) :]
    bar = max((np.flatnonzero(row < 128) for row in foot), key=lambda dark: (dark < 1400).sum())
    bar = bar[bar < 1400]
    assert (bar.max() - bar.min()) / dpi * 25.4 == pytest.approx(100.0, abs=0.3)


def test_the_pdf_has_the_papers_size(tmp_path):
    for paper, (width_mm, height_mm) in PAPERS_MM.items():
        write_board_pdf(tmp_path / "board.pdf", BoardSpec(), paper)
        content = (tmp_path / "board.pdf").read_bytes()
        box = [float(n) for n in content.split(b"/MediaBox [ ")[1].split(b" ]")[0].split()]
        assert np.allclose(box, [0, 0, width_mm / 25.4 * 72, height_mm / 25.4 * 72], atol=0.01)


@pytest.mark.parametrize(
    "wrong",
    [
        {"columns": 2}, {"rows": 40}, {"square_m": 0.0001}, {"square_m": 3.0}, {"dictionary": "9X9_1"},
        {"columns": 12, "rows": 10},
    ],
)  # fmt: skip
def test_a_board_that_cannot_be_is_refused_in_a_sentence(wrong):
    with pytest.raises(InputError) as refused:
        BoardSpec(**wrong)
    assert str(refused.value).endswith(".") and ";" in str(refused.value)


def test_a_board_too_large_for_the_paper_is_refused(tmp_path):
    with pytest.raises(InputError, match="does not fit on A4"):
        write_board_pdf(tmp_path / "board.pdf", BoardSpec(square_m=0.05), "a4")
    with pytest.raises(InputError, match="no paper 'a5'"):
        write_board_pdf(tmp_path / "board.pdf", BoardSpec(), "a5")
