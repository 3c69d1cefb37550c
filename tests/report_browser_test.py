#!/usr/bin/env python3
"""The report in a browser, headless: loads without errors or requests, plays, steps, jumps, reads, compares.

  report_browser_test.py --program ERARD_SIM --keystrokes DIR [--pictures DIR] [unittest arguments]

--pictures DIR also writes the pictures of docs/report.md. Exit code 77 (skipped) without Chromium or python3-selenium.
"""
import argparse
import csv
import json
import os
import pathlib
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time
import unittest
import xml.etree.ElementTree

try:
    from selenium import webdriver
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.by import By
except ImportError:
    print("skipped: python3-selenium is not installed")
    sys.exit(77)

CHROMIUM = shutil.which("chromium") or shutil.which("google-chrome")
DRIVER = shutil.which("chromedriver")
FLAGS = ["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync", "--disable-extensions", "--hide-scrollbars"]
OPTIONS = None  # of the command line
WORK = None     # folder of this run: piano/, turned/ (a screw turned, compared with piano), measured/, stopped/


def simulate(*arguments):
    return subprocess.run([OPTIONS.program, *map(str, arguments)], check=True, capture_output=True, text=True, cwd=WORK)


def make_runs():
    piano = OPTIONS.keystrokes / "piano.csv"
    simulate("--keystroke", piano, "--out", WORK / "piano", "--svg", "0.1155")
    simulate("--keystroke", piano, "--set", "S_Jy=0.0588", "--compare", "piano", "--out", WORK / "turned")
    simulate("--keystroke", piano, "--compare", "piano/trajectory.csv", "--out", WORK / "measured")
    simulate("--keystroke", OPTIONS.keystrokes / "forte.csv", "--damper", "on", "--out", WORK / "damper")
    stopped = subprocess.Popen([OPTIONS.program, "--keystroke", str(piano), "--duration", "3600", "--out", str(WORK / "stopped")],
                               stdout=subprocess.DEVNULL)
    time.sleep(1)
    stopped.send_signal(signal.SIGINT)
    assert stopped.wait(60) == 130


class Page:
    """One report in one browser."""

    def __init__(self, run, width=1280, height=800, fragment=""):
        options = webdriver.ChromeOptions()
        options.binary_location = CHROMIUM
        self.profile = tempfile.mkdtemp()
        for flag in [*FLAGS, f"--user-data-dir={self.profile}", f"--window-size={width},{height}"]:
            options.add_argument(flag)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        try:
            from selenium.webdriver.chrome.service import Service
            self.driver = webdriver.Chrome(service=Service(DRIVER), options=options)
        except TypeError:
            self.driver = webdriver.Chrome(options=options)
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                    {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600})
        self.driver.get("about:blank")
        for kind in ["browser", "performance"]:
            self.driver.get_log(kind)  # forget what the browser did for itself
        self.driver.get((WORK / run / "report.html").as_uri() + "#" + fragment)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.driver.quit()
        shutil.rmtree(self.profile, ignore_errors=True)

    def js(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def press(self, keys):
        self.driver.find_element(By.TAG_NAME, "body").send_keys(keys)

    def click(self, selector):
        self.js("arguments[0].click()", self.driver.find_element(By.CSS_SELECTOR, selector))

    def text(self, selector):
        return self.driver.find_element(By.CSS_SELECTOR, selector).get_attribute("textContent")

    def row(self):
        return self.js("return erard.page.player.row")

    def requests(self):
        """Addresses that the page asked for, itself excepted."""
        sent = []
        for entry in self.driver.get_log("performance"):
            message = json.loads(entry["message"])["message"]
            if message["method"] == "Network.requestWillBeSent":
                sent.append(message["params"]["request"]["url"])
        return [url for url in sent if "report.html" not in url]


class Report(unittest.TestCase):
    def trajectory(self, run="piano"):
        with open(WORK / run / "trajectory.csv", newline="") as file:
            return list(csv.DictReader(file))

    def test_loads_fast_without_errors_or_requests(self):
        for run in ["piano", "turned", "measured", "damper", "stopped"]:
            with self.subTest(run=run), Page(run) as page:
                time.sleep(0.3)
                self.assertEqual(page.driver.get_log("browser"), [])
                self.assertEqual(page.requests(), [])
                spent = page.js("const t = performance.getEntriesByType('navigation')[0]; return t.loadEventEnd")
                print(f"  {run}: {(WORK / run / 'report.html').stat().st_size / 1e6:.2f} MB, loaded in {spent:.0f} ms")
                self.assertLess(spent, 2000)

    def test_plays_pauses_and_keeps_up(self):
        with Page("piano") as page:
            self.assertEqual(page.row(), 0)
            page.press(" ")
            time.sleep(2.5)
            frames = page.js("return erard.page.player.frame_times")
            page.press(" ")
            row = page.row()
            self.assertGreater(row, 100)  # 2.5 s at 1/20 are 250 rows
            time.sleep(0.2)
            self.assertEqual(page.row(), row)
            work = page.js("""const p = erard.page.player, start = performance.now();
                for (let k = 0; k < 200; ++k) p.go(1e-3 * k); return (performance.now() - start) / 200""")
            print(f"  frames of {statistics.median(frames):.1f} ms (median), of which scripts {work:.2f} ms")
            self.assertLess(work, 16)  # 60 frames a second; how fast the browser paints without a screen is its own affair

    def test_steps_and_jumps(self):
        with Page("piano") as page:
            page.press("\ue014")  # right
            self.assertEqual(page.row(), 1)
            page.click("#forward")
            self.assertEqual(page.row(), 2)
            page.press("\ue012")  # left
            self.assertEqual(page.row(), 1)
            events = page.js("return erard.page.player.events")
            self.assertGreaterEqual(len(events), 6)
            for k, event in enumerate(events):
                page.press(str(k + 1))
                self.assertEqual(page.row(), page.js("return erard.page.run.row(arguments[0])", event["time_s"]))
                self.assertLess(abs(page.js("return erard.page.player.time") - event["time_s"]), 0.26e-3)
            page.press("\ue011")  # home
            page.press("n")
            page.click('#events button[data-event="hammer_meets_string"]')
            self.assertAlmostEqual(page.js("return erard.page.player.time"), 0.1155, delta=6e-4)
            page.press("p")
            self.assertLess(page.js("return erard.page.player.time"), 0.115)

    def test_values_at_the_cursor_are_those_of_the_trajectory(self):
        rows = self.trajectory()
        with Page("piano") as page:
            page.js("document.getElementById('all').open = true")
            for k in [0, 100, 231, 600, len(rows) - 1]:
                page.js("erard.page.player.go_to_row(arguments[0])", k)
                cells = page.js("""return Object.fromEntries([...document.querySelectorAll('#columns td[data-column]')]
                    .map(cell => [cell.dataset.column, cell.textContent]))""")
                for name, text in rows[k].items():
                    if name == "t_s":
                        self.assertAlmostEqual(page.js("return erard.page.player.time"), float(text), delta=1e-9)
                        continue
                    value = float(text)
                    # single precision: 6e-8, shown with eight digits
                    self.assertAlmostEqual(float(cells[name]), value, delta=2e-7 * abs(value) + 1e-12, msg=f"{name}, row {k}")
                readout = float(page.text('.curve .value[data-column="force_N"]'))
                self.assertAlmostEqual(readout, float(rows[k]["force_N"]), delta=6e-4)

    def point_on_plot(self, page, k, ms):
        """Offset of an instant from the middle of a plot [px], and the plot."""
        time.sleep(0.3)  # until the plots have their size
        over = page.js("return erard.page.plots.plots[arguments[0]].chart.over", k)
        left, width = page.js("const c = erard.page.plots.plots[arguments[0]].chart; return [c.valToPos(arguments[1], 'x'), c.over.clientWidth]", k, ms)
        return over, round(left - width / 2)

    def test_a_click_on_a_curve_goes_there_and_a_drag_zooms(self):
        with Page("piano") as page:
            over, at = self.point_on_plot(page, 0, 300)
            ActionChains(page.driver).move_to_element_with_offset(over, at, 0).click().perform()
            self.assertAlmostEqual(page.js("return erard.page.player.time"), 0.3, delta=4e-3)  # two pixels
            over, at = self.point_on_plot(page, 1, 100)
            to = self.point_on_plot(page, 1, 150)[1]
            ActionChains(page.driver).move_to_element_with_offset(over, at, 0).click_and_hold().move_by_offset(to - at, 0).release().perform()
            time.sleep(0.3)
            for low, high in page.js("return erard.page.plots.plots.map(p => [p.chart.scales.x.min, p.chart.scales.x.max])"):
                self.assertAlmostEqual(low, 100, delta=4)
                self.assertAlmostEqual(high, 150, delta=4)
            self.assertAlmostEqual(page.js("return erard.page.player.time"), 0.3, delta=4e-3)

    def test_zoom_of_one_plot_is_that_of_all(self):
        with Page("piano") as page:
            page.js("erard.page.plots.plots[1].chart.setScale('x', {min: 100, max: 150})")
            time.sleep(0.2)
            for low, high in page.js("return erard.page.plots.plots.map(p => [p.chart.scales.x.min, p.chart.scales.x.max])"):
                self.assertEqual([low, high], [100, 150])

    def test_the_page_places_bodies_where_the_program_does(self):
        """The same pose as SVG by the program and on the page."""
        root = xml.etree.ElementTree.parse(WORK / "piano" / "pose_0.1155.svg").getroot()
        marks = {}
        for node in root.iter("{http://www.w3.org/2000/svg}path"):
            title = node.find("{http://www.w3.org/2000/svg}title")
            if node.get("class").startswith("mark-"):
                x, y = node.get("transform").split("(")[1].split(")")[0].split()
                marks[title.text.split(",")[0]] = (node.get("class"), float(x), float(y))
        self.assertEqual(len(marks), 12)
        with Page("piano", fragment="t=0.1155") as page:
            on_page = page.js("""const p = document.querySelectorAll('#drawing [class^=mark-]');
                return [...p].map(n => [erard.page.run.scene.contacts[n.dataset.contact].name, n.getAttribute('class'),
                                        n.transform.baseVal.getItem(0).matrix.e, n.transform.baseVal.getItem(0).matrix.f])""")
        self.assertEqual(len(on_page), 12)
        for name, kind, x, y in on_page:
            self.assertEqual(kind, marks[name][0], name)
            self.assertAlmostEqual(x, marks[name][1], delta=2e-3)
            self.assertAlmostEqual(y, marks[name][2], delta=2e-3)

    def test_compare_shows_both_runs(self):
        with Page("turned", fragment="t=0.1155") as page:
            self.assertGreater(page.js("return document.querySelectorAll('#drawing .ghost path').length"), 20)
            self.assertIn("η", page.text("#compared"))
            self.assertGreaterEqual(len(page.driver.find_elements(By.CSS_SELECTOR, "#compared tr[data-event]")), 5)
            row = page.row()
            here, other = page.text('.curve .value[data-column="force_N"]').split("|")
            self.assertAlmostEqual(float(here), float(self.trajectory("turned")[row]["force_N"]), delta=6e-4)
            self.assertAlmostEqual(float(other), float(self.trajectory("piano")[row]["force_N"]), delta=6e-4)
        with Page("measured", fragment="t=0.1") as page:
            here, other = page.text('.curve .value[data-column="force_N"]').split("|")
            self.assertAlmostEqual(float(here), float(other), delta=1e-3)  # the same run as a bare curve
            self.assertIn("0.00 %", page.text("#compared"))

    def test_a_stopped_run_says_so(self):
        with Page("stopped") as page:
            self.assertIn("INTERRUPTED", page.text("#status"))
            self.assertEqual(page.driver.find_element(By.ID, "status").get_attribute("class"), "bad")

    def test_fits_a_telephone(self):
        for width in [390, 1280]:
            with self.subTest(width=width), Page("turned", width, 844) as page:
                self.assertLessEqual(page.js("return document.documentElement.scrollWidth"), width)
                smallest = page.js("""return Math.min(...[...document.querySelectorAll('button, td, dd, p')]
                    .filter(n => n.offsetParent).map(n => parseFloat(getComputedStyle(n).fontSize)))""")
                self.assertGreaterEqual(smallest, 10.5)

    def test_dark_and_light(self):
        with Page("piano", fragment="theme=dark") as page:
            paper = "return getComputedStyle(document.getElementById('stage')).backgroundColor"
            dark = page.js(paper)
            page.press("d")
            self.assertNotEqual(page.js(paper), dark)

    def test_names_what_is_pointed_at(self):
        with Page("piano", fragment="t=0.139") as page:
            told = page.js("""const p = document.querySelectorAll('#drawing path'), names = new Set();
                const view = erard.page.view; for (const n of p) if (n.dataset.name) names.add(n.dataset.name); return [...names]""")
            for name in ["key lever", "whippen", "jack", "repetition lever", "hammer shank", "knuckle", "backcheck",
                         "let-off button", "drop screw", "string", "capstan screw"]:
                self.assertIn(name, told)


def make_pictures(folder):
    folder.mkdir(parents=True, exist_ok=True)
    shots = [("report", "piano", 1280, 800, "t=0.1108"), ("report_dark_string", "piano", 1280, 800, "t=0.1155&theme=dark"),
             ("report_check", "piano", 1280, 800, "t=0.1390&view=hammer and backcheck"),
             ("report_knuckle", "piano", 1280, 800, "t=0.1129&view=jack and knuckle"),
             ("report_damper", "damper", 1280, 800, "t=0.0560"),
             ("report_compare", "turned", 1280, 1480, "t=0.1108"), ("report_390", "piano", 390, 844, "t=0.2580"),
             ("report_390_dark", "piano", 390, 844, "t=0.1170&theme=dark")]
    for name, run, width, height, fragment in shots:
        with Page(run, width, height, fragment) as page:
            time.sleep(0.5)
            page.driver.save_screenshot(str(folder / (name + ".png")))


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", required=True)
    parser.add_argument("--keystrokes", required=True, type=pathlib.Path)
    parser.add_argument("--pictures", type=pathlib.Path)
    OPTIONS, rest = parser.parse_known_args()
    OPTIONS.keystrokes = OPTIONS.keystrokes.resolve()
    OPTIONS.program = str(pathlib.Path(OPTIONS.program).resolve())
    if not CHROMIUM or not DRIVER:
        print("skipped: chromium or chromedriver is not installed")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as work:
        WORK = pathlib.Path(work)
        os.environ.setdefault("HOME", work)
        make_runs()
        if OPTIONS.pictures:
            make_pictures(OPTIONS.pictures)
            sys.exit(0)
        unittest.main(argv=[sys.argv[0], *rest], verbosity=2)
