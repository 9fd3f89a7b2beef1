"""What a report says of a run: the question, the verdicts, statics and modes, the motion, peaks and pictures."""

import base64
import hashlib
import json
import math
import re
import warnings
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest
from finished_runs import finished_of, tables_of, with_parts
from house import sdof_text

import wirerope_mj as wr
from wirerope_mj.assessment.criteria import EXCEEDED, NOT_JUDGED, STRUCK, WITHIN, judge
from wirerope_mj.assessment.criteria.verdict import Criterion, against_limit, most_used
from wirerope_mj.content.blocks import Chart, Curve, Panel, SceneView, short
from wirerope_mj.content.credibility import reliance
from wirerope_mj.content.model import model_blocks
from wirerope_mj.content.numbers import ABSENT, MINUS, fixed, number
from wirerope_mj.content.run import accelerations_chart, run_content
from wirerope_mj.content.run_spectra import run_spectra
from wirerope_mj.content.scene_outline import crowded_label, worst_instant
from wirerope_mj.content.selection import worst_names
from wirerope_mj.content.verdicts import unjudged
from wirerope_mj.engine.response import Peak
from wirerope_mj.foundation.errors import Absent, RecordWarning
from wirerope_mj.foundation.payload_limits import PayloadLimit
from wirerope_mj.foundation.tables import Table
from wirerope_mj.foundation.units import in_unit, instant_text
from wirerope_mj.runs.report import write_report
from wirerope_mj.runs.scenario import Scenario, load_scenario
from wirerope_mj.views.plots.svg_chart import chart_svg
from wirerope_mj.views.report import report_html

HOSTILE = "<script>alert('deck')</script>"


class Page(HTMLParser):
    """The elements of a page, the text of each, and that all of them are closed."""

    VOID = frozenset({"meta", "img", "br", "hr", "link"})

    def __init__(self, text):
        super().__init__()
        self.elements, self.open, self.text, self.cells = [], [], [], []
        self.feed(text)
        self.close()
        assert not self.open, f"never closed: {self.open}"

    def handle_starttag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text.append(data)
        if "td" in self.open:
            self.cells.append(data.strip())

    def all(self, tag):
        return [attributes for name, attributes in self.elements if name == tag]

    @property
    def words(self):
        return " ".join(" ".join(self.text).split())


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    """Return the folder of a short run of one mount that travels too far."""
    folder = tmp_path_factory.mktemp("runs") / "table"
    wr.run_scenario(load_scenario("shock_table").make(duration=0.15, level_g=60.0), folder)
    return folder


@pytest.fixture(scope="module")
def page(table):
    return Page((table / "report.html").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def finished(table):
    """Return what the report of that run is made of."""
    return finished_of(table)


@pytest.fixture(scope="module")
def content(finished):
    """Return that report before it is set."""
    return run_content(finished)


def run_of(place, *, name="run", question="How far?", gravity=9.80665, motion=None, isolator="a", **arguments):
    """Return the folder of a run of one mass on one mount."""
    law = wr.BoucWen(alpha=5e4, beta=40.0, gamma=10.0, n=1.0, k=2e4)
    scenario = Scenario(
        question=question,
        model=sdof_text(gravity=gravity),
        motion=motion or wr.HalfSine(peak=100.0, duration=0.011, direction="z", start=0.01),
        simulate={"duration": 0.1, "timestep": 5e-4, **arguments},
        isolators={"a": wr.Isolator(name=isolator, axial=law)},
        name=name,
    )
    wr.run_scenario(scenario, place / "run")
    return place / "run"


def table_called(content, title):
    """Return the table whose title begins so, of the answer or of a section."""
    return next(table for table in tables_of(content).values() if table.title.startswith(title))


def rows_of(table):
    """Return the texts of a table as the page shows them, a tuple for each row."""
    return [tuple(text for text, _ in row) for row in table.marks(absent=ABSENT, minus=MINUS)]


def record_of(place, *, values, rate=4000.0, name="deck.csv"):
    """Write a record along z [m/s^2] and return its file."""
    rows = "\n".join(f"{number / rate:.6f},{value:.7g}" for number, value in enumerate(values))
    (place / name).write_text(f"time [s],z [m/s^2]\n{rows}\n", encoding="utf-8")
    return place / name


def system_with(run, names):
    """Return the system of a run as if all of some mounts were its only one."""
    mount = run.system.mounts["m1"]
    return replace(run.system, mounts=dict.fromkeys(names, mount))


def words_of(folder):
    return Page((folder / "report.html").read_text(encoding="utf-8")).words


def test_every_run_folder_holds_a_report_of_well_formed_html(page):
    assert page.elements[0][0] == "html"
    schemes = [attributes["content"] for attributes in page.all("meta") if attributes.get("name") == "color-scheme"]
    assert schemes == ["light dark"]


def test_the_first_sheet_draws_each_criterion_as_a_bar_and_the_worst_instant(page, finished):
    content = run_content(finished)
    (table,) = [block for block in content.blocks("headline") if getattr(block, "id", "") == "criteria"]
    used = [row[2].content for row in table.rows]
    assert used == sorted(used, reverse=True)
    assert max(used) > 1.0
    bars = [attributes["style"] for attributes in page.all("span") if "style" in attributes]
    assert bars == [f"--used: {min(value, 1.25):.4g}" for value in used]
    ids = [block.id for block in content.blocks("headline")]
    assert ids.index("passage") < ids.index("criteria") < ids.index("worst-instant") < ids.index("first-charts")
    (chart,) = [block for block in content.blocks("headline") if block.id == "first-charts"]
    acceleration, deflection, _ = chart.rows[0]
    assert {name for name, _ in deflection.limits} == {"rated travel of m1"}
    assert acceleration.curves[0].kind != deflection.curves[0].kind  # one colour for one subject
    for panel, kind in ((acceleration, "acceleration"), (deflection, "travel")):  # its mark is what is judged, where and when
        name = panel.curves[0].name
        rows = [row for row in finished.verdicts if row.subject == name and row.criterion.kind == kind]
        worst = max(rows, key=lambda row: (row.utilisation or 0.0, row.value))
        assert (
            panel.notes[0][2].lstrip(MINUS)
            == f"{number(in_unit(worst.value, panel.unit))} {panel.unit} at {instant_text(worst.time)}"
        )
        assert bool(panel.exceeded) == (worst.verdict == EXCEEDED)


def test_the_page_needs_nothing_but_itself(page):
    assert not {"link", "iframe", "object", "base"} & {tag for tag, _ in page.elements}
    assert all(attributes.get("src") is None for attributes in page.all("script"))
    assert page.all("img") == []
    charts = [attributes["aria-label"] for attributes in page.all("svg")]
    # worst instant (2), charts of the first sheet, model (2), key;
    # base, its spectrum, accelerations, spectra, limits, deflections, forces, loops, stops
    assert len(charts) == 6 + 9
    assert all(charts)
    style = page.words[: page.words.index("Shock and vibration report")]
    assert "url(" not in style
    assert "@import" not in style


@pytest.mark.quick
def test_the_question_and_the_verdict_come_first(page, table):
    words = page.words
    verdicts = judge(wr.load_response(table))
    verdicts = [*verdicts, next(row for row in verdicts if row.criterion.startswith("static load"))]  # relaxed as well
    over = [row for row in verdicts if row.verdict == EXCEEDED]
    judged_ones = [row for row in verdicts if row.verdict in (WITHIN, EXCEEDED)]
    assert over
    headline = f"{len(over)} of {len(judged_ones)} checks exceeded"
    assert words.index("How far does one catalogue mount") < words.index(headline) < words.rindex("Model and mounts")


def test_the_words_of_every_verdict_are_those_of_the_criteria(content, finished, table):
    verdicts = finished.verdicts
    found = [row for row in judge(wr.load_response(table)) if not row.criterion.startswith("static load")]
    assert verdicts[: len(found)] == tuple(found)
    rows = tables_of(content)["all-verdicts"].rows
    assert len(rows) == len(verdicts)
    told = sorted((row[0], row[2], row[1].content) for row in rows)
    assert told == sorted((v.criterion, v.subject, v.verdict) for v in verdicts)
    tones = {row[1].content: row[1].tone for row in rows}
    assert tones == {WITHIN: "within", EXCEEDED: "exceeded", NOT_JUDGED: "unjudged", STRUCK: "exceeded"}


def test_what_is_not_judged_is_said_with_its_reason(page):
    assert "travel in tension of m1: no travel in tension is rated." in page.words
    assert "acceleration of block, block_top: no limit is stated." in page.words


def test_mounts_isolators_and_their_provenance_are_named(page):
    assert "m1" in page.cells
    assert "Enidine WR12-400: catalogue figures. Source: ITT Enidine WR series catalogue" in page.words
    assert "Assumed: tension travel is not stated and not judged." in page.words


def test_sag_and_modes_are_those_of_statics_and_modes(page):
    system = wr.load_system("shock_table")
    assert "Virgin: of 490.3 N of weight the mounts carry 490.3 N." in page.words  # 50 kg, guided: no contact carries
    for history in ("virgin", "relaxed"):
        sag = 1e3 * wr.equilibrium(system, history=history).mounts["m1"].deflection[2]
        assert fixed(sag, 3) in page.cells
        for frequency in wr.modes(system, history=history).frequencies:
            assert f"{frequency:.3f}" in page.cells


def test_peaks_and_numerics_are_those_of_the_response(page, table):
    response = wr.load_response(table)
    peak = response.peaks.bodies["block"].acceleration
    assert f"{peak.value / wr.STANDARD_GRAVITY:.2f}" in page.cells
    assert f"{response.numerics.steps} steps of at most" in page.words
    assert re.search(r"versions.*mujoco \d", page.words)


def test_the_peak_of_the_base_is_that_of_its_closed_form(content):
    (row,) = rows_of(table_called(content, "Extremes of the base"))
    assert row[:3] == ("z", "0", "60.0")  # samples 0.5 ms apart would miss it by up to 0.3 %


def test_the_peak_of_a_record_that_falls_between_the_samples_is_reported(tmp_path):
    time = np.arange(0.0, 0.05, 1e-4)
    inside = (time >= 0.0103) & (time <= 0.0123)
    values = np.where(inside, 10.0 * wr.STANDARD_GRAVITY * np.sin(math.pi * (time - 0.0103) / 0.002), 0.0)
    motion = wr.load_record(record_of(tmp_path, values=values, rate=1e4))
    run = finished_of(run_of(tmp_path, motion=motion, duration=0.04, timestep=1e-4))
    content = run_content(run)
    sampled = np.abs(run.response.base.acceleration[:, 2]).max() / wr.STANDARD_GRAVITY
    assert sampled < 9.0  # 0.3 ms beside the peak of a pulse of 2 ms: cos(0.15 pi) = 0.89 of it
    assert rows_of(table_called(content, "Extremes of the base"))[0][:3] == ("z", "0", "10.0")
    assert rows_of(tables_of(content)["peak-accelerations"])[0][:2] == ("deck (base)", "10.00")


def test_warnings_of_a_record_are_in_the_answer_in_the_motion_and_in_the_summary(tmp_path):
    time = np.arange(0.0, 0.2, 1.0 / 4000.0)
    pulse = np.where((time > 0.02) & (time < 0.031), 150.0 * np.sin(math.pi * (time - 0.02) / 0.011), 0.0)
    path = record_of(tmp_path, values=np.minimum(pulse, 98.0665))
    with pytest.warns(RecordWarning, match="saturated"):
        motion = wr.load_record(path)
    folder = run_of(tmp_path, motion=motion)
    path.unlink()  # the folder is enough
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    (told,) = summary["record_warnings"]
    assert told.startswith("deck.csv: ")
    assert "saturated" in told
    before = (folder / "report.html").read_bytes()
    with pytest.warns(RecordWarning, match="saturated"):
        write_report(folder)
    assert (folder / "report.html").read_bytes() == before
    words = words_of(folder)
    assert words.count(told) == 2
    assert words.index(told) < words.index("The worst of every criterion") < words.index("Base motion: record ", 2000)
    assert words.index("Base motion: record ", 2000) < words.rindex(told) < words.rindex("What reaches the payload")
    assert "After the end of the run at 0.1 s, and not simulated: record deck.csv ends." in words
    assert "record deck.csv begins" in words
    assert "0.1998 record" not in words


def test_a_sweep_whose_end_lies_between_two_samples_is_simulated_to_its_end(tmp_path):
    sweep = wr.Sweep(start=10.0, stop=33.0, rate=61.0 * 60.0, acceleration=1.0, direction="z")  # octaves a minute
    folder = run_of(tmp_path, motion=sweep, duration=sweep.duration)
    assert wr.load_response(folder).time[-1] < sweep.duration
    words = words_of(folder)
    assert "sweep reaches 33 Hz" in words
    assert "not simulated" not in words


def test_the_baseline_correction_stands_in_the_motion_with_its_picture(tmp_path):
    time = np.arange(0.0, 0.1, 1.0 / 4000.0)
    signal = 20.0 * np.sin(2.0 * math.pi * 30.0 * time) * np.hanning(time.size)
    offset = 0.4 - signal.mean()  # so that 0.4 m/s^2 is the mean
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RecordWarning)
        motion = wr.load_record(record_of(tmp_path, values=signal + offset), baseline="mean")
        folder = run_of(tmp_path, motion=motion)
        content = run_content(finished_of(folder))
    section = next(section for section in content.sections if section.title == "Base motion")
    captions = [block.caption for block in section.blocks if isinstance(block, Chart)]
    assert len(captions) == 3  # motion, correction, spectrum
    assert captions[1].startswith(
        "The whole record deck.csv along z, as measured and as it is played, baseline: the mean taken off. At its end "
    )
    measured, played = rows_of(table_called(content, "What the baseline correction changes"))
    assert (measured[:2], played[:2]) == (("z", "as measured"), ("z", "as played"))
    # The mean is 0.4 m/s^2 over 399 intervals; the trapezoidal rule leaves half a sample's worth at either end, 5e-5 m/s.
    assert abs(float(measured[3]) - 0.4 * 399 / 4000) < 3e-4
    assert abs(float(played[3].replace("−", "-"))) < 3e-4


def test_a_record_that_is_not_doubted_is_reported_as_it_is(tmp_path):
    time = np.arange(0.0, 0.1, 1.0 / 4000.0)
    values = 20.0 * np.sin(2.0 * math.pi * 30.0 * time) * np.hanning(time.size)
    folder = run_of(tmp_path, motion=wr.load_record(record_of(tmp_path, values=values)))
    assert json.loads((folder / "summary.json").read_text(encoding="utf-8"))["record_warnings"] == []
    words = words_of(folder)
    assert "Said of the measured record" not in words
    assert "as it is played, no baseline correction." in words


def test_static_loads_are_judged_after_either_history(finished):
    static = [row for row in finished.verdicts if row.criterion.startswith("static load")]
    assert {row.criterion: row.value for row in static} == {
        f"static load in compression, {history}": finished.statics.sags[history].mounts["m1"].compression
        for history in ("virgin", "relaxed")
    }
    missing = replace(finished.statics, sags={"virgin": finished.statics.virgin}, missing={"relaxed": "it slips."})
    verdicts = judge(finished.response, statics=missing)
    assert unjudged([verdicts[-1]]) == ("static load in compression, relaxed of every mount: it slips.",)
    assert verdicts[-1].verdict == NOT_JUDGED


def test_bodies_with_limits_are_drawn_before_larger_accelerations(finished):
    response, peaks = finished.response, finished.response.peaks
    assert worst_names(response) == ["block"]  # block_top moves alike
    point = peaks.points["block_top"]
    twice = replace(point, acceleration=Peak.of(2.0 * point.acceleration.numbers))
    faster = replace(response, peaks=replace(peaks, points={"block_top": twice}))
    assert worst_names(faster) == ["block_top", "block"]
    limits = (PayloadLimit(kind="acceleration", name="block", values=(100.0,)),)
    assert worst_names(replace(faster, scene=replace(faster.scene, limits=limits))) == ["block", "block_top"]


def test_the_first_of_several_lines_lies_over_the_others_and_the_base_behind_them(finished):
    svg = chart_svg(accelerations_chart(finished, ["block", "block_top"]))
    panel = svg[svg.index('class="panel"') :]
    assert re.findall('data-name="([^"]*)"', panel) == ["base", "block_top", "block"]  # drawn one over the other


def test_what_oscillates_too_often_for_a_line_is_a_filled_band_and_named_so():
    time = np.linspace(0.0, 20.0, 20_001)
    fast, slow = (Curve(name="a", x=time, y=np.sin(2 * np.pi * f * time), kind=0) for f in (50.0, 0.1))
    svg = chart_svg(Chart(rows=[[Panel(curves=[fast], ylabel="y")]]))
    (band,) = re.findall(r'fill-opacity="0.3" d="M([^"]*)Z"', svg)
    points = np.array(re.split("[ L]", band), dtype=float).reshape(-1, 2)
    assert points[0, 0] == points[-1, 0] == points[:, 0].min()  # along the upper end, and back along the lower
    assert np.ptp(points[:, 1]) > 100.0
    assert "filled: lowest to highest" in svg
    assert "filled" not in chart_svg(Chart(rows=[[Panel(curves=[slow], ylabel="y")]]))


def test_the_contents_lead_to_every_part(page):
    links = [attributes["href"] for attributes in page.all("a")]
    parts = [f"#{attributes['id']}" for attributes in page.all("section") if "id" in attributes]
    assert links == parts
    assert len(links) >= 7


def test_only_the_script_of_the_page_itself_may_run(table):
    report_text = (table / "report.html").read_text(encoding="utf-8")
    (script,) = re.findall(r"<script>(.*?)</script>", report_text, re.S)
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    assert f"script-src 'sha256-{digest}'" in report_text
    assert "default-src 'none'" in report_text
    assert not re.search(
        r"https?://(?!www\.w3\.org/2000/svg)", script + "".join(re.findall(r"<svg.*?</svg>", report_text, re.S))
    )


def test_values_are_read_back_from_a_chart_as_they_are(finished):
    """What the script computes from places and ranges is the deflection, to a tenth of a unit of a panel's 110."""
    (chart,) = [block for block in run_content(finished).blocks() if getattr(block, "id", "") == "deflections"]
    svg = chart_svg(chart)
    panel = svg[svg.rindex('class="panel"') :]
    x0, x1, y0, y1 = map(float, re.search('data-ranges="([^"]*)"', panel)[1].split())
    left, top, width, height = map(float, re.search('data-area="([^"]*)"', panel)[1].split())
    path = re.search(r'data-name="m1" d="M([^"]*)"', panel)[1]
    places = np.array(path.split(), dtype=float).reshape(-1, 2)
    time = x0 + (places[:, 0] - left) / width * (x1 - x0)
    value = y0 + (top + height - places[:, 1]) / height * (y1 - y0)
    exact = np.interp(time, finished.response.time, 1e3 * finished.response.mounts["m1"].deflection[:, 2])
    steep = np.abs(np.gradient(exact, time)).max() * 0.05 * (x1 - x0) / width  # of a place across, rounded too
    np.testing.assert_allclose(value, exact, atol=0.06 * (y1 - y0) / height + steep)


@pytest.mark.quick
def test_a_label_is_explained_only_where_it_is_drawn(finished):
    scene = finished.response.scene

    def mounts_at(*places):
        mounts = [replace(scene.mounts[0], name=f"m{n}", base_point=np.array([*place, 0.0])) for n, place in enumerate(places)]
        return replace(scene, mounts=tuple(mounts))

    corners = [(-3.0, -1.0), (3.0, -1.0), (-3.0, 1.0), (3.0, 1.0)]
    assert crowded_label(mounts_at(*corners)) is None
    assert crowded_label(mounts_at(*corners, (3.0, 0.0))) == (
        "m1 +2",
        3,
    )  # seen along y, the longer extent to the right
    for place, words in ((corners, False), ([*corners, (3.0, 0.0)], True)):
        response = replace(finished.response, scene=mounts_at(*place))
        isolators = [f"m{n}" for n in range(len(place))]
        run = with_parts(finished, response=response, system=system_with(finished, isolators), modes={})
        caption = next(block for block in model_blocks(run) if isinstance(block, SceneView)).caption
        assert ('"m1 +2": 3 mounts behind each other.' in caption) == words
        assert ("behind" in caption) == words


def test_names_of_users_are_escaped_and_without_gravity_there_is_no_sag(tmp_path):
    isolator = f"{HOSTILE} $\\frac{{1}}{{2}}$"
    folder = run_of(tmp_path, name=HOSTILE, question=f"{HOSTILE} & why?", isolator=isolator, gravity=0.0)
    text = (folder / "report.html").read_text(encoding="utf-8")
    assert text.count("<script") == 1  # the page's own
    page = Page(text)
    assert f"{HOSTILE} & why?" in page.words
    assert f"{isolator}: illustrative figures." in page.words
    assert "The model has no gravity: the mounts carry nothing at rest." in page.words
    assert "relaxed" not in page.words


@pytest.mark.quick
@pytest.mark.parametrize(
    ("motion", "rate", "words"),
    [
        (wr.VelocityStep(velocity=1.0, direction="z", start=0.02), 1000.0, "The base's velocity jumps"),
        (wr.Sine(frequency=20.0, acceleration=5.0, direction="z"), 1000.0, "The base is driven steadily"),
        (wr.HalfSine(peak=50.0, duration=0.011, direction="z"), 10.0, "At 10 samples a second"),
        (wr.HalfSine(peak=50.0, duration=0.011, direction="z", start=1.0), 1000.0, "The base rests"),
    ],
)
def test_a_run_without_a_spectrum_says_why(motion, rate, words):
    isolators = {"a": wr.Isolator(name="a", axial=wr.KelvinVoigt(k=2e4, c=20.0))}
    system = wr.load_system(sdof_text(), isolators=isolators)
    response = wr.simulate(system, motion, duration=0.1, timestep=1e-3, sample_rate=rate)
    spectra = run_spectra(motion, response, ["mass"], rate)
    assert isinstance(spectra, Absent)
    assert spectra.reason.startswith(words)


def test_a_sweep_is_shown_over_frequency_and_has_no_spectrum(tmp_path):
    sweep = wr.Sweep(start=20.0, stop=40.0, rate=60.0, acceleration=5.0, direction="z")
    words = words_of(run_of(tmp_path, motion=sweep, duration=0.5))
    assert "over the frequency of the sweep" in words
    assert "at [Hz]" in words
    assert "The base is driven steadily: a shock response spectrum would say little" in words


@pytest.mark.slow
def test_random_vibration_is_shown_by_its_density(tmp_path):
    level = 4.0  # (m/s^2)^2/Hz over 40 Hz: 12.65 m/s^2 rms
    motion = wr.RandomVibration(psd=[(10.0, level), (50.0, level)], duration=6.0, seed=3, direction="z", rise=0.5, fall=0.5)
    folder = run_of(tmp_path, motion=motion, duration=6.0)
    page = Page((folder / "report.html").read_text(encoding="utf-8"))
    assert "PSDs are shown instead of SRS" in page.words
    caption = "Power spectral densities of mass and of the base while the response is stationary: "
    length = float(page.words.split(caption)[1].split()[0])
    assert 3.5 < length < 5.0  # [s]: of the 5 that are stationary, what the response needs to settle is left out
    # One sample of 4 s: with 40 Hz of bandwidth its rms is known to 1 / (2 sqrt(40 * 4)) = 4 %; three times that is allowed.
    rms = float(page.words.split("Root mean squares")[1].split(" base z ")[1].split()[0])
    assert abs(rms / (math.sqrt(40.0 * level) / wr.STANDARD_GRAVITY) - 1.0) < 0.11
    # Where there is no density along an axis, a body has the rms that is judged: as if the base had moved along x alone.
    run = finished_of(folder)
    content = run_content(with_parts(run, spectra=replace(run.spectra, densities={"x": run.spectra.densities["z"]})))
    turned = rows_of(table_called(content, "Root mean squares"))
    plain = {(row[0], row[1]): row[2] for row in turned}
    assert turned[2][4] == "–"
    assert [tuple(row[:2]) for row in turned] == [("base", "z"), ("mass", "x"), ("mass", "z")]
    # windows of the density and all samples alike differ by some per cent of a short sample
    assert abs(float(plain["mass", "z"]) / float(plain["mass", "x"]) - 1.0) < 0.1
    (judged,) = [row.value for row in run.random if row.subject == "mass" and row.criterion == "rms acceleration along z"]
    assert float(plain["mass", "z"]) == pytest.approx(judged / wr.STANDARD_GRAVITY, rel=5e-3)  # as it is shown


def test_a_record_is_reported_from_the_copy_in_the_folder(tmp_path):
    time = np.arange(0.0, 0.1, 1e-3)
    values = 20.0 * np.sin(2.0 * math.pi * 30.0 * time) * np.hanning(time.size)
    path = tmp_path / "deck.csv"
    rows = "\n".join(f"{t:.4f},{a:.6f}" for t, a in zip(time, values, strict=True))
    path.write_text(f"time [s],z [m/s^2]\n{rows}\n", encoding="utf-8")
    folder = run_of(tmp_path, motion=wr.load_record(path))
    path.unlink()
    (page,) = write_report(folder, out=tmp_path / "again.html")
    assert page.read_bytes() == (folder / "report.html").read_bytes()
    assert "Shock response spectrum of the base" in words_of(folder)


def test_what_cannot_be_found_is_said_instead(finished):
    reason = "there is no relaxed equilibrium: mount 'm1' carries nothing."
    statics = replace(finished.statics, sags={"virgin": finished.statics.virgin}, missing={"relaxed": reason})
    run = with_parts(finished, statics=statics, modes={"relaxed": Absent(reason=reason)})
    words = Page(report_html(run_content(run))).words
    assert words.count(reason) == 2
    assert f"Relaxed: {reason}" in words


def test_a_response_without_mounts_has_no_sections_about_them(finished):
    response = finished.response
    bare = replace(response, scene=replace(response.scene, mounts=()), mounts={})
    run = with_parts(finished, response=bare, modes={}, verdicts=())
    content = run_content(run)
    titles = [section.title for section in content.sections if section.title and section.blocks]
    shown = ["Peak accelerations", "Stops and contacts", "Model and mounts", "Base motion", "What reaches the payload"]
    assert titles == [*shown, "How far this can be relied on", "Numerics, options and versions"]
    assert content.verdict.text == "NOT JUDGED: no limit is stated for anything in this run."
    Page(report_html(content))


@pytest.mark.quick
def test_long_names_are_numbered_in_the_drawing(finished):
    scene = finished.response.scene
    long = "A-starboard_quarter_mount_1"
    mounts = (replace(scene.mounts[0], name=long),)
    response = replace(finished.response, scene=replace(scene, mounts=mounts))
    blocks = list(model_blocks(with_parts(finished, response=response, system=system_with(finished, [long]), modes={})))
    mount_table = next(block for block in blocks if isinstance(block, Table) and block.id == "mount-places")
    assert mount_table.columns[0].heading == "no."
    assert mount_table.rows[0][:2] == ("1", long)
    assert "numbers" in next(block for block in blocks if isinstance(block, SceneView)).caption


def test_long_names_in_legends_keep_what_tells_them_apart():
    names = [short(f"starboard_quarter_mount_number_{place}") for place in range(3)]
    assert names[0] == "starboard_qua…mount_number_0"
    assert len(set(names)) == 3
    assert short("$m_1$") == "$m_1$"  # pictures parse no formulas


@pytest.mark.quick
def test_pictures_show_samples_column_by_column(finished, monkeypatch):
    """A response of ten minutes is larger than memory: no more than a vector may be asked for at once."""
    widths = []

    class Narrow:
        names = finished.response.samples.names

        def columns(self, first, last):
            widths.append(last - first)
            return finished.response.samples.columns(first, last)

    run = with_parts(finished, response=replace(finished.response, samples=Narrow()), spectra=finished.spectra)
    content = run_content(with_parts(run, selection=finished.selection))
    assert [section.blocks for section in content.sections if section.id in ("payload", "mounts-in-motion")]
    assert max(widths) <= 3


def test_a_line_says_where_a_verdict_is_nearer_to_its_limit_than_the_peaks_are_known(finished):
    error = finished.response.numerics.error_estimate
    assert 0.0 < error < 0.01
    worst = most_used(finished.verdicts)
    for beyond, said in ((0.5 * error, True), (-0.5 * error, True), (0.2, False), (-0.2, False), (-1.0, False)):
        row = replace(worst, value=(1.0 + beyond) * worst.limit)
        assert ("differ from the limit by less" in reliance(with_parts(finished, verdicts=(row,))).text) == said, beyond


def test_the_worst_instant_names_what_is_more_critical_and_has_none(finished):
    worst = most_used(finished.verdicts)
    at_rest = replace(worst, criterion=Criterion("static load", sense="virgin"), value=9.0 * worst.value, time=None)
    caption = worst_instant(with_parts(finished, verdicts=(at_rest, *finished.verdicts))).caption
    assert f"what is more critical, {against_limit(at_rest)}, has no instant" in caption
    assert "more critical" not in worst_instant(finished).caption
