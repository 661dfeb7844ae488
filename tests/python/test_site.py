# SPDX-License-Identifier: MIT
"""The site of the documentation: `make site` builds it, a browser opens it, its search finds."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
OPTIONS = ["--headless", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=20000"]


@pytest.fixture(scope="module", name="site")
def _site(tmp_path_factory):
    pytest.importorskip("material", reason="mkdocs-material is not installed")
    place = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", place]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return place


def open_page(address, folder):
    """What a browser has made of a page."""
    if CHROMIUM is None:
        pytest.skip("there is no chromium (scripts/packages.txt)")
    command = [CHROMIUM, *OPTIONS, f"--user-data-dir={folder}", "--dump-dom", address]
    done = subprocess.run(command, capture_output=True, text=True, timeout=240)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.slow
def test_every_page_leads_back_and_asks_no_server(site):
    """Each page has links to the front page and to the parts, and loads nothing from elsewhere."""
    pages = [page for page in site.rglob("*.html") if page.name != "404.html"]
    sources = [page for page in (ROOT / "docs").rglob("*.md")]
    assert len(pages) == len(sources) + 2  # README.md, CHANGELOG.md
    for page in pages:
        text = page.read_text(encoding="utf-8")
        up = "../" * (len(page.relative_to(site).parts) - 1)
        for target in ("index.html", "jobs/index.html", "manual/index.html"):
            found = re.findall(r'href="([^"#]*)"', text)
            assert any((page.parent / link).resolve() == site / target for link in found), page
        assert not re.findall(r'(?:src|<link[^>]*href)="https?://', text), (page, up)


@pytest.mark.slow
def test_lists_and_tables_of_all_pages_are_lists_and_tables(site):
    """A list or a table without an empty line before it would stand in a paragraph."""
    for page in site.rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        body = text[text.find("<article") : text.find("</article")]
        for paragraph in re.findall(r"<p>(.*?)</p>", body, re.DOTALL):
            assert not re.search(r"\n(- |\| )|```", paragraph), (page.name, paragraph[:80])


@pytest.mark.slow
def test_a_browser_shows_a_job_and_its_picture(site, tmp_path):
    text = open_page((site / "jobs/wall.html").as_uri(), tmp_path)
    assert "<h1" in text
    assert "Blast on a rigid wall or building" in text
    picture = re.search(r'src="([^"]*figures/jobs/wall.png)"', text)[1]
    assert (site / "jobs" / picture).resolve().is_file()


@pytest.mark.slow
def test_the_search_finds_without_a_server(site, tmp_path):
    """The page is a file, and the word one of a job."""
    text = open_page((site / "index.html").as_uri() + "?q=spall", tmp_path)
    links = re.findall(r'href="([^"]*)" class="md-search-result__link"', text)
    assert any("jobs/spall.html" in link for link in links), links
