"""A user writes a profile in the workbench with the keyboard alone and gets an ICD
without findings.
"""

from __future__ import annotations

import json
import re
import shutil
import signal
import subprocess
import sys
import threading
import urllib.error
import urllib.request
from contextlib import contextmanager

import pytest
import yaml

from icdgen.importer import profile, sources
from icdgen.importer.workbench import server
from icdgen.importer.workbench.session import Session
from icdgen.loading import load
from tests.importer.rules.drawing import draw, heading, open_table, table, text

NAMES = ("chromium", "chromium-browser", "google-chrome")


def manual(path):
    """Return a manual with two messages of one kind and a table of pins."""
    return draw(path, [
        heading("4 Telemetry"), heading("4.1 Motor state (0x21)", 2), text("Sent once a second."),
        table([["Byte", "Name", "Unit", "Remarks"], ["0", "Mode", "", "see below"], ["1-2", "Speed", "rpm", ""]]),
        heading("4.2 Supply (0x22)", 2), text("Sent on request."),
        table([["Byte", "Name", "Unit", "Remarks"], ["0-1", "Voltage", "mV", ""], ["2-3", "Current", "mA", ""]]),
        heading("5 Pins"), table([["Pin", "Function"], ["1", "GND"], ["2", "VCC"]]),
    ])  # fmt: skip


@pytest.fixture
def session(tmp_path):
    manual(tmp_path / "motor.pdf")
    document, tables = sources.read(tmp_path / "motor.pdf", profile.load(), jobs=1)
    return Session(document, tables, tmp_path / "rules.yaml", tmp_path / "icd")


@pytest.fixture
def address(session):
    with server.serve(session) as running:
        thread = threading.Thread(target=running.serve_forever, daemon=True)
        thread.start()
        yield f"http://{server.HOST}:{running.server_port}"
        running.shutdown()
        thread.join()


def ask(address, path, data=None, headers=None):
    body = None if data is None else json.dumps(data).encode()
    request = urllib.request.Request(address + path, body, headers or {"X-Icdgen": "1"})
    with urllib.request.urlopen(request) as answer:
        return (
            json.loads(answer.read())
            if "json" in answer.headers["Content-Type"]
            else answer.read()
        )


RULE = {
    "tables": {"head": "Byte | Name | Unit"},
    "message": {"heading": r"^[\d.]+ {message} \({id}\)$", "kind": "telemetry"},
    "columns": {
        "Byte": "^{byte}(?:-{last_byte})?$",
        "Name": "name",
        "Unit": "unit",
        "Remarks": "text",
    },
    "each": {"type": "uint"},
    "width": "unit",
}


def test_a_rule_gives_fields_and_findings_of_all_tables_of_its_kind_at_once(address):
    state = ask(address, "/api/state")
    assert [(kind["titles"], kind["tables"]) for kind in state["kinds"]] == [
        (["Byte", "Name", "Unit", "Remarks"], [1, 2]),
        (["Pin", "Function"], [3]),
    ]
    assert [table["rules"] for table in state["tables"]] == [[], [], []]
    state = ask(address, "/api/rule", {"index": None, "rule": RULE})["state"]
    assert [(table["rules"], table["fields"], table["messages"]) for table in state["tables"]] == [
        ([0], 2, ["Motor state"]), ([0], 2, ["Supply"]), ([], 0, []),
    ]  # fmt: skip
    assert [
        finding["code"]
        for finding in state["findings"]
        if finding["severity"] == "warning"
    ] == ["IMP100"]
    (message,) = ask(address, "/api/table/1")["messages"]
    assert [(f["at"], f["bits"], f["name"], f["unit"]) for f in message["fields"]] == [
        (0, 8, "Mode", ""),
        (8, 16, "Speed", "rpm"),
    ]


def test_a_rule_with_errors_keeps_its_last_valid_form_and_other_rules_still_work(
    address,
):
    ask(address, "/api/rule", {"index": None, "rule": RULE})
    wrong = {**RULE, "columns": {**RULE["columns"], "Name": "nam"}}
    state = ask(address, "/api/rule", {"index": 0, "rule": wrong})["state"]
    (error,) = state["errors"]
    assert (error["rule"], error["message"]) == (
        0,
        "`nam` is neither a role nor a pattern with a role",
    )
    assert "did you mean the role `name`?" in error["help"]
    assert state["tables"][0]["fields"] == 2
    refused = ask(address, "/api/rule-text", {"index": 0, "text": "tables: {head: ["})[
        "refused"
    ]
    assert "not YAML" in refused[0]["message"]
    pins = {"tables": {"head": "Pin | Function"}, "what": "ignore"}
    state = ask(address, "/api/rule", {"index": None, "rule": pins})["state"]
    assert [(table["rules"], table["fields"]) for table in state["tables"]] == [
        ([0], 2),
        ([0], 2),
        ([1], 0),
    ]
    state = ask(address, "/api/rule", {"index": 1, "rule": None})["state"]
    assert state["errors"] == [error] and [
        table["rules"] for table in state["tables"]
    ] == [
        [0],
        [0],
        [],
    ]
    for action in ("undo", "undo", "undo"):
        state = ask(address, f"/api/{action}", {})["state"]
    assert state["errors"] == [] and [table["fields"] for table in state["tables"]] == [
        2,
        2,
        0,
    ]


def test_a_new_rule_with_errors_belongs_to_its_tables_and_gives_nothing(
    address, session, tmp_path
):
    rule = {
        "tables": {"head": "Pin | Function"},
        "what": "enumeration",
        "columns": {"Pin": "value", "Function": "member"},
    }
    state = ask(address, "/api/rule", {"index": None, "rule": RULE})["state"]
    state = ask(address, "/api/rule", {"index": None, "rule": rule})["state"]
    assert [error["rule"] for error in state["errors"]] == [1]
    assert [table["rules"] for table in state["tables"]] == [[0], [0], [1]]
    assert ask(address, "/api/save", {})["done"]["files"] == [
        f"{tmp_path}/rules.yaml: written"
    ]
    assert not (tmp_path / "icd").exists()
    state = ask(
        address,
        "/api/rule",
        {"index": 1, "rule": rule | {"message": {"enumeration": "Pins"}}},
    )["state"]
    assert state["errors"] == []


def test_saving_does_not_overwrite_what_another_program_wrote(
    address, session, tmp_path
):
    path = tmp_path / "rules.yaml"
    ask(address, "/api/rule", {"index": None, "rule": RULE})
    assert "conflict" not in ask(address, "/api/save", {})["done"]
    edited = path.read_text(encoding="utf-8").replace(
        "node: {}", "node: {byte_order: big}  # page 3"
    )
    path.write_text(edited, encoding="utf-8")
    written = (tmp_path / "icd" / "motor.yaml").read_bytes()
    ask(address, "/api/node", {"byte_order": "little"})
    saved = ask(address, "/api/save", {})["done"]
    assert saved == {
        "conflict": f"{path} was changed by another program; nothing is written"
    }
    assert (
        path.read_text(encoding="utf-8") == edited
        and (tmp_path / "icd" / "motor.yaml").read_bytes() == written
    )
    state = ask(address, "/api/reload", {})["state"]
    assert (
        state["node"] == {"byte_order": "big"}
        and state["is_saved"]
        and session.text == edited
    )
    assert ask(address, "/api/undo", {})["state"]["node"] == {"byte_order": "little"}
    path.write_text("rules: [", encoding="utf-8")
    (refused,) = ask(address, "/api/reload", {})["refused"]
    assert "not YAML" in refused["message"] and session.node() == {
        "byte_order": "little"
    }
    assert "conflict" not in ask(address, "/api/save", {"overwrite": True})["done"]
    assert path.read_text(encoding="utf-8") == session.text
    path.unlink()
    assert (
        "was removed" in ask(address, "/api/save", {})["done"]["conflict"]
        and not path.exists()
    )


def test_a_second_rule_of_a_table_stands_behind_the_first(address, session):
    ask(address, "/api/rule", {"index": None, "rule": RULE})
    ask(
        address,
        "/api/rule",
        {
            "index": None,
            "rule": {"tables": {"head": "Pin | Function"}, "what": "ignore"},
        },
    )
    second = {
        "tables": RULE["tables"],
        "what": "bits",
        "message": {"of": "Mode"},
        "ignore": ["Byte"],
    }
    answer = ask(address, "/api/rule", {"index": None, "rule": second, "behind": 0})
    assert answer["done"] == 1
    assert [table["rules"] for table in answer["state"]["tables"]] == [
        [0, 1],
        [0, 1],
        [2],
    ]
    assert yaml.safe_load(session.text)["rules"][:2] == [{**RULE, "also": True}, second]
    assert (
        yaml.safe_load(ask(address, "/api/undo", {}) and session.text)["rules"][0]
        == RULE
    )


def test_pages_of_other_sites_change_nothing(address, session):
    before = session.text
    for headers in ({"X-Other": "1"}, {"X-Icdgen": "1", "Host": "example.org"}):
        with pytest.raises(urllib.error.HTTPError) as refused:
            ask(address, "/api/rule", {"index": None, "rule": RULE}, headers)
        assert refused.value.code == 403
    for path, data in (
        ("/api/rule", {"rule": 1}),
        ("/api/nothing", {}),
        ("/api/rule", []),
    ):
        with pytest.raises(urllib.error.HTTPError) as refused:
            ask(address, path, data)
        assert refused.value.code == 400
    for path in ("/api/table/9", "/picture/9", "/page.py", "/../session.py"):
        with pytest.raises(urllib.error.HTTPError) as refused:
            ask(address, path)
        assert refused.value.code == 404
    assert session.text == before
    assert ask(address, "/picture/1").startswith(b"\x89PNG")


@contextmanager
def browser():
    """Open a page of Chromium. Errors in scripts fail the test."""
    program = next((path for name in NAMES if (path := shutil.which(name))), None)
    if program is None:
        pytest.skip("no Chromium: scripts/test installs it")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        running = playwright.chromium.launch(
            executable_path=program, args=["--no-sandbox"]
        )
        new_page = running.new_page(viewport={"width": 1600, "height": 900})
        problems: list[str] = []
        new_page.on("pageerror", lambda error: problems.append(str(error)))
        new_page.on(
            "console",
            lambda message: (
                problems.append(message.text) if message.type == "error" else None
            ),
        )
        yield new_page
        assert problems == []
        running.close()


@pytest.fixture
def page(address):
    with browser() as opened_page:
        opened_page.goto(address)
        opened_page.get_by_role("heading", name="table 1").wait_for()
        yield opened_page


def answered(page, typed: str):
    """Wait for the answer to the change that sends the typed text. The answer to an
    earlier change may come first.
    """
    return page.expect_response(
        lambda response: (
            response.url.endswith("/api/rule")
            and typed in (response.request.post_data or "")
        )
    )


def tab_to(page, label: str) -> None:
    """Press Tab until the control of this name has the focus, which proves that the
    keyboard reaches it.
    """
    script = """() => { const one = document.activeElement;
        return one.getAttribute("aria-label") || one.labels?.[0]?.textContent.trim() || one.textContent.trim(); }"""
    for _ in range(120):
        page.keyboard.press("Tab")
        name = page.evaluate(script)
        if name and name.startswith(label):
            return
    raise AssertionError(f"Tab does not lead to `{label}`")


def test_a_profile_is_written_with_the_keyboard_alone(page, session, tmp_path):
    tab_to(page, "Byte order")
    page.keyboard.press("b")  # big
    tab_to(page, "Make a rule for this kind")
    page.keyboard.press("Enter")
    page.get_by_label("These tables are").wait_for()
    for label, value in (
        ("Type of all fields", "uint"),
        ("Kind", "telemetry"),
        ("From a heading", r"^[\d.]+ {message} \({id}\)$"),
    ):
        tab_to(page, label)
        page.keyboard.type(value)
    tab_to(page, "a position alone is one unit")
    page.keyboard.press("Space")
    for label, value in (
        ("Role of Byte", "^{byte}(?:-{last_byte})?$"),
        ("Role of Remarks", "text"),
    ):
        tab_to(page, label)
        page.keyboard.press("Control+a")
        page.keyboard.type(value)
    page.keyboard.press("Tab")
    page.get_by_role("status").filter(has_text="0 errors, 1 warning").wait_for()
    assert page.locator("table.fields").inner_text().split("\n")[1].split("\t")[:4] == [
        "0",
        "8",
        "Mode",
        "uint",
    ]
    tab_to(page, "?3 ")  # the table of pins, which has no rule
    page.keyboard.press("Enter")
    page.get_by_role("heading", name="table 3").wait_for()
    tab_to(page, "Ignore this kind")
    page.keyboard.press("Enter")
    page.get_by_role("status").filter(has_text="0 errors, 0 warnings").wait_for()
    page.keyboard.press("Control+s")
    page.get_by_role("status").filter(has_text="no findings").wait_for()

    written = yaml.safe_load((tmp_path / "rules.yaml").read_text(encoding="utf-8"))
    # The bit order does not matter for complete bytes.
    assert written["node"] == {"byte_order": "big"}
    assert [rule.get("what", "message") for rule in written["rules"]] == [
        "message",
        "ignore",
    ]
    loaded = load([tmp_path / "icd" / "motor.yaml"])
    assert loaded.findings == []
    state, supply = loaded.icd.nodes[0].messages
    assert [(f.name, f.at, f.bits) for f in state.fields] == [
        ("Mode", 0, 8),
        ("Speed", 8, 16),
    ]
    assert (supply.name, supply.ids, supply.length) == ("Supply", (0x22,), 4)


def test_the_picture_of_the_page_shows_the_tables_and_leads_to_them(page):
    page.get_by_label("show table 2").first.click()
    page.get_by_role("heading", name="table 2").wait_for()
    outline = page.get_by_label("show table 2").first.bounding_box()
    image = page.get_by_alt_text("page 1").bounding_box()
    assert (
        image["x"] < outline["x"]
        and outline["y"] + outline["height"] < image["y"] + image["height"]
    )
    assert outline["width"] > 0.2 * image["width"]
    assert (
        page.get_by_label("show table 2").first.get_attribute("aria-current") == "true"
    )


def test_changes_are_undone_and_made_again_with_the_keyboard(page, session):
    first = session.text
    page.get_by_role("button", name="Ignore this kind").click()
    page.get_by_role("button", name="Remove the rule").wait_for()
    changed = session.text
    page.keyboard.press("Control+z")
    page.get_by_role("button", name="Ignore this kind").wait_for()
    assert session.text == first
    page.keyboard.press("Control+Shift+z")
    page.get_by_role("button", name="Remove the rule").wait_for()
    assert session.text == changed
    page.get_by_role("button", name="Undo").click()
    # A new change clears the list of changes to redo.
    page.get_by_role("button", name="Make a rule for this kind").click()
    page.get_by_label("These tables are").wait_for()
    assert page.get_by_role("button", name="Redo").is_disabled()


def test_words_and_numbered_headings_have_controls(page, session):
    from playwright.sync_api import expect

    page.get_by_role("button", name="Make a rule for this kind").click()
    page.get_by_label("Words mean").fill(
        "kind: TC = telecommand, TM = telemetry; type: CHAR = text"
    )
    page.get_by_label("Headings that number columns").fill("^D{bit}$")
    page.get_by_label("Role of their cells").fill("^{name}$")
    page.keyboard.press("Tab")
    page.get_by_text("The rule as YAML").click()
    expect(page.get_by_label("The rule as YAML")).to_have_value(re.compile("{name}"))
    (rule,) = yaml.safe_load(session.text)["rules"]
    assert rule["map"] == {
        "kind": {"TC": "telecommand", "TM": "telemetry"},
        "type": {"CHAR": "text"},
    }
    assert rule["melt"] == "^D{bit}$" and rule["columns"]["*"] == "^{name}$"


def test_the_document_is_read_again_by_the_headings_of_rules(tmp_path):
    rows = [["Item", "Wert", "Bemerkung"], ["0", "Mode", "-"]]
    draw(
        tmp_path / "motor.pdf", [heading("4.1 Motor state (0x21)", 2), open_table(rows)]
    )
    words = profile.load()

    def reader(own):
        return sources.read(tmp_path / "motor.pdf", own, jobs=1)

    session = Session(*reader(words), tmp_path / "rules.yaml", tmp_path / "icd", reader)
    assert session.tables == []
    rule = {
        "tables": {"head": "Item | Wert | Bemerkung"},
        "columns": {"Item": "byte", "Wert": "name"},
        "ignore": ["Bemerkung"],
    }
    session.set_rule(None, rule)
    session.read_document()
    assert [table.titles for table in session.tables] == [["Item", "Wert", "Bemerkung"]]
    assert session.state()["tables"][0]["rules"] == [0]


def test_the_yaml_of_a_rule_contains_keys_without_a_control(page):
    from playwright.sync_api import expect

    page.get_by_role("button", name="Make a rule for this kind").click()
    page.get_by_text("The rule as YAML").click()
    rule = page.get_by_label("The rule as YAML")
    rule.fill(rule.input_value() + "    set: [{where: {name: ^Speed$}, type: int}]\n")
    page.get_by_role("button", name="Apply").click()
    expect(rule).to_have_value(re.compile(re.escape("set: [{where: {name: '^Speed$'}")))
    rule.fill("tables: {head: [")
    page.get_by_role("button", name="Apply").click()
    page.get_by_role("alert").filter(has_text="not YAML").wait_for()


def test_the_command_serves_the_page_until_it_is_interrupted(tmp_path):
    manual(tmp_path / "motor.pdf")
    command = [
        sys.executable,
        "-m",
        "icdgen",
        "import",
        "motor.pdf",
        "--profile",
        "mine.yaml",
        "--workbench",
    ]
    # A background job ignores interrupts.
    with subprocess.Popen(
        command,
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    ) as running:
        line = running.stdout.readline()
        address = re.search("http://[0-9.:]+", line)
        assert (
            line.startswith("motor.pdf: 3 tables; open http://127.0.0.1:") and address
        )
        assert len(ask(address[0], "/api/state")["tables"]) == 3
        running.send_signal(signal.SIGINT)
        assert running.wait(20) == 0
        assert running.stderr.read() == ""
    assert not (tmp_path / "mine.yaml").exists()
    (tmp_path / "words.yaml").write_text(
        "profile: 1\ncaptions: [Listing]\n", encoding="utf-8"
    )
    command[-2] = "words.yaml"
    refused = subprocess.run(
        command, cwd=tmp_path, capture_output=True, text=True, timeout=60
    )
    assert refused.returncode == 1 and "the profile has no `rules:`" in refused.stderr


def test_the_page_asks_before_it_overwrites_the_work_of_an_editor(page, tmp_path):
    page.get_by_role("button", name="Ignore this kind").click()
    page.get_by_role("button", name="Save profile and ICD").click()
    page.get_by_role("status").filter(has_text="written").wait_for()
    edited = (tmp_path / "rules.yaml").read_text(encoding="utf-8") + "# of the editor\n"
    (tmp_path / "rules.yaml").write_text(edited, encoding="utf-8")
    page.get_by_role("button", name="Remove the rule").click()
    page.get_by_role("button", name="Ignore this kind").wait_for()
    page.get_by_role("button", name="Save profile and ICD").click()
    page.get_by_role("alert").filter(
        has_text="was changed by another program"
    ).wait_for()
    page.get_by_role("button", name="Reload the file").click()
    page.get_by_role("button", name="Remove the rule").wait_for()
    assert not page.get_by_role("button", name="Overwrite the file").is_visible()
    assert (tmp_path / "rules.yaml").read_text(encoding="utf-8") == edited
    page.get_by_role("button", name="Undo").click()
    page.get_by_role("button", name="Ignore this kind").wait_for()
    # The page has read the file, so this is no conflict.
    page.keyboard.press("Control+s")
    page.get_by_role("status").filter(has_text="written").wait_for()
    assert "of the editor" not in (tmp_path / "rules.yaml").read_text(encoding="utf-8")


def test_the_findings_of_check_are_shown_after_saving(page, address, tmp_path):
    twins = {
        **RULE,
        "message": {
            **RULE["message"],
            "id": "0x21",
            "heading": r"^[\d.]+ {message} \(0x",
        },
    }
    ask(address, "/api/rule", {"index": None, "rule": twins})
    page.reload()
    page.get_by_role("heading", name="table 1").wait_for()
    page.keyboard.press("Control+s")
    page.get_by_role(
        "heading", name="icdgen check of the saved ICD: 1 error"
    ).wait_for()
    shown = page.locator("#checked li.error").inner_text()
    assert "error ICD" in shown and re.search(r"motor\.yaml:[0-9]+\n.+", shown)


def test_an_error_of_a_rule_leads_to_its_table(page):
    page.get_by_role("button", name="Make a rule for this kind").click()
    page.get_by_label("Role of Name").fill("nam")
    page.keyboard.press("Tab")
    error = page.get_by_role("alert").filter(
        has_text="Rule 1: `nam` is neither a role nor a pattern with a role"
    )
    error.wait_for()
    page.get_by_label("show table 3").first.click()
    page.get_by_role("heading", name="table 3").wait_for()
    page.get_by_role("button", name="Ignore this kind").click()
    page.get_by_role("button", name="(ignored)").wait_for()
    error.get_by_role("button", name="table 1").click()
    page.get_by_role("heading", name="table 1").wait_for()
    assert page.get_by_label("Role of Name").input_value() == "nam"


def test_a_rule_offers_only_what_its_kind_uses(page):
    page.get_by_role("button", name="Make a rule for this kind").click()
    length, of = page.get_by_label("Length"), page.get_by_label("Of the field")
    page.get_by_label("These tables are").wait_for()
    assert length.is_visible() and not of.is_visible()
    page.get_by_label("These tables are").select_option("enumeration")
    of.wait_for()
    assert not length.is_visible()
    assert page.locator("#roles option[value=member]").count() == 1
    assert page.locator("#roles option[value=last_byte]").count() == 0


def test_a_click_that_ends_typing_is_not_lost(page, session):
    from playwright.sync_api import expect

    page.get_by_role("button", name="Make a rule for this kind").click()
    expect(page.get_by_label("These tables are")).to_be_focused()
    page.get_by_label("Type of all fields").fill("uint")
    box = page.locator("#tables button").nth(1).bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    with answered(page, '"uint"'):
        page.mouse.down()  # the control loses the focus, so that the change is sent
    page.wait_for_timeout(300)
    page.mouse.up()
    page.get_by_role("heading", name="table 2").wait_for()
    assert yaml.safe_load(session.text)["rules"][0]["each"] == {"type": "uint"}


def test_an_enumeration_gets_its_name_from_a_control(page, session):
    page.get_by_role("button", name="Make a rule for this kind").click()
    page.get_by_label("These tables are").select_option("bits")
    page.get_by_label("Enumeration", exact=True).fill("Mode")
    with answered(page, '"Mode"'):
        page.keyboard.press("Tab")
    assert yaml.safe_load(session.text)["rules"][0]["message"] == {
        "enumeration": "Mode"
    }


def test_each_rule_of_a_table_is_edited(page, session):
    from playwright.sync_api import expect

    page.get_by_role("button", name="Make a rule for this kind").click()
    page.get_by_role("button", name="Add another rule for this table").click()
    expect(page.get_by_role("group", name="Rule 2, for 2 tables")).to_be_visible()
    page.get_by_label("Type of all fields").fill("int")
    page.get_by_role("button", name="Rule 1: message").click()
    expect(page.get_by_role("group", name="Rule 1, for 2 tables")).to_be_visible()
    page.get_by_label("Type of all fields").fill("uint")
    page.keyboard.press("Tab")
    expect(page.get_by_role("button", name="Rule 1: message")).to_have_attribute(
        "aria-pressed", "true"
    )
    page.get_by_text("The rule as YAML").click()
    expect(page.get_by_label("The rule as YAML")).to_have_value(re.compile("uint"))
    first, second = yaml.safe_load(session.text)["rules"]
    assert (first["each"], first["also"], second["each"]) == (
        {"type": "uint"},
        True,
        {"type": "int"},
    )
    page.get_by_label("The rule as YAML").fill(session.text.split("rules:\n")[1])
    page.get_by_role("button", name="Apply").click()
    page.get_by_role("alert").filter(
        has_text="one rule only: the text has 2 list items"
    ).wait_for()


ARRAYS = [
    ["Byte", "Name", "Size", "Count", "Group", "Values"],
    ["0", "Mode", "1", "", "", "0: off, 1: on"],
    ["1", "Level", "12", "6", "", ""],
    ["13", "Current", "2", "20", "Channel", ""],
    ["15", "State", "2", "20", "Channel", ""],
]


def test_the_result_has_enumerations_counts_and_strides(tmp_path):
    draw(tmp_path / "motor.pdf", [heading("4.1 Motor state (0x21)", 2), table(ARRAYS)])
    session = Session(
        *sources.read(tmp_path / "motor.pdf", profile.load(), jobs=1),
        tmp_path / "rules.yaml",
        tmp_path / "icd",
    )
    session.set_rule(None, {
        "tables": {"head": "Byte | Name | Size | Count"}, "each": {"type": "uint"},
        "message": {"heading": r"^[\d.]+ {message} \({id}\)$", "kind": "telemetry"},
        "columns": {"Byte": "byte", "Name": "name", "Size": "bytes", "Count": "count", "Group": "group", "Values": "members"},
    })  # fmt: skip
    assert session.state()["errors"] == []
    with server.serve(session) as running, browser() as opened_page:
        threading.Thread(target=running.serve_forever, daemon=True).start()
        opened_page.goto(f"http://{server.HOST}:{running.server_port}")
        opened_page.locator("table.fields").wait_for()
        rows = [
            row.split("\t")[2:5]
            for row in opened_page.locator("table.fields").inner_text().split("\n")[1:]
        ]
        assert rows == [
            ["Mode", "enum Mode", ""], ["Level", "uint", "6 times, every 2 bytes"],
            ["Current", "uint", "Channel: 20 times, every 4 bytes"], ["State", "uint", "Channel: 20 times, every 4 bytes"],
        ]  # fmt: skip
        assert opened_page.locator(".bits").count() == 1
        opened_page.get_by_text("Bytes 32 to 92").click()
        opened_page.get_by_label("layout of the bits of bytes 32 to 92").wait_for()
        assert opened_page.locator(".bits .byte").all_inner_texts() == [
            str(byte) for byte in range(93)
        ]
        running.shutdown()


def test_a_long_pattern_has_the_width_of_its_column_while_it_is_edited(page):
    page.get_by_role("button", name="Make a rule for this kind").click()
    role = page.get_by_label("Role of Unit")
    role.wait_for()
    before = page.get_by_label("Role of Remarks").bounding_box()
    role.focus()
    assert role.bounding_box()["width"] > 500 > 3 * before["width"]
    assert page.get_by_label("Role of Remarks").bounding_box() == before
    assert (
        page.evaluate(
            "(() => { const work = document.getElementById('work'); return work.scrollWidth - work.clientWidth; })()"
        )
        == 0
    )
