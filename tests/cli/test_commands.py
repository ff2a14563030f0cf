"""``check``, ``rule``, ``fmt``, ``show``, ``decode`` and ``encode`` as commands:
output, exit status, errors.
"""

from __future__ import annotations

import io
import json
import sys

import pytest

from tests.conftest import DEMO


class TestCheck:
    def test_clean_is_0_and_findings_are_1(self, icdgen, demo):
        assert icdgen("check", demo).status == 0
        demo.write_text(DEMO.replace("bits: 4", "bits: 14"))
        result = icdgen("check", demo)
        assert result.status == 1
        assert "error[ICD020]" in result.out and "^^" in result.out

    def test_the_shipped_icds_are_clean(self, icdgen):
        result = icdgen("check")
        assert (result.status, result.out) == (0, "no findings\n")

        assert (
            "no ICD is in the current folder, so icdgen checked its shipped ICDs"
            in (result.err)
        )
        assert "help: `icdgen check FILE` takes another one" in result.err

    @pytest.mark.parametrize("command", ["check", "fmt"])
    def test_the_icds_of_the_current_folder_are_the_default(
        self, icdgen, tmp_path, command
    ):
        broken = DEMO.replace("length: 3", "length: [")
        (tmp_path / "pump.yaml").write_text(broken)
        (tmp_path / "other.yaml").write_text("tool: of another kind\n")
        (tmp_path / "below").mkdir()
        (tmp_path / "below" / "valve.yaml").write_text(broken)
        result = icdgen(command)
        assert result.status == 1
        findings = result.out + result.err
        assert "pump.yaml:" in findings and "valve.yaml:" not in findings
        assert (
            "ed pump.yaml\n" in result.err and f"`icdgen {command} FILE`" in result.err
        )

    def test_the_folder_icd_is_part_of_the_default(self, icdgen, demo, tmp_path):
        (tmp_path / "pump.yaml").write_text(DEMO.replace("name: demo", "name: pump"))
        result = icdgen("check")
        assert (result.status, result.out) == (0, "no findings\n")
        assert "checked pump.yaml and icd\n" in result.err

    def test_the_configuration_precedes_the_icds_of_the_folder(
        self, icdgen, demo, tmp_path
    ):
        (tmp_path / "icdgen.toml").write_text('icds = ["icd/demo.yaml"]\n')
        (tmp_path / "pump.yaml").write_text("icdgen: 1\n")
        result = icdgen("check")
        assert (result.status, result.out, result.err) == (0, "no findings\n", "")

    @pytest.mark.parametrize("form", ["json", "sarif"])
    def test_json_forms_are_json(self, icdgen, demo, form):
        demo.write_text(DEMO.replace("length: 3", "length: 2"))
        assert "ICD020" in json.dumps(
            json.loads(icdgen("check", "--format", form, demo).out)
        )

    def test_github_annotations_name_file_line_and_column(self, icdgen, demo):
        demo.write_text(DEMO.replace("length: 3", "length: 2"))
        out = icdgen("check", "--format", "github", demo).out
        assert out.startswith("::error ") and "file=icd/demo.yaml,line=15," in out

    def test_an_unknown_format_is_misuse(self, icdgen, demo):
        assert icdgen("check", "--format", "xml", demo).status == 2


class TestRule:
    def test_a_rule_is_explained_with_examples(self, icdgen):
        out = icdgen("rule", "ICD021").out
        assert "ICD021" in out and "Wrong" in out and "Right" in out

    def test_without_a_code_all_rules_are_listed(self, icdgen):
        out = icdgen("rule").out
        assert "ICD020" in out and "ICD080" in out

    def test_an_unknown_code_is_misuse(self, icdgen):
        result = icdgen("rule", "ICD999")
        assert result.status == 2 and "there is no rule ICD999" in result.err


class TestFmt:
    def test_check_names_files_and_writes_nothing(self, icdgen, demo):
        untidy = DEMO.replace("bits: 4,  name", "bits: 4, name")
        demo.write_text(untidy)
        result = icdgen("fmt", "--check", demo)
        assert result.status == 1 and "demo.yaml" in result.out
        assert demo.read_text() == untidy

    def test_a_second_run_changes_nothing(self, icdgen, demo):
        icdgen("fmt", demo)
        assert icdgen("fmt", "--check", demo).status == 0

    def test_fmt_reports_the_changed_files(self, icdgen, demo):
        demo.write_text(DEMO.replace("bits: 4,  name", "bits: 4, name"))
        assert (
            "1 file not in the canonical layout" in icdgen("fmt", "--check", demo).out
        )
        assert "1 file formatted" in icdgen("fmt", demo).out
        assert "1 file unchanged" in icdgen("fmt", demo).out

    @pytest.mark.parametrize("data", [b"a: [", b"\xff\xfe", b""])
    def test_a_file_that_is_no_yaml_is_a_finding_and_unchanged(
        self, icdgen, demo, data
    ):
        demo.write_bytes(data)
        result = icdgen("fmt", demo)
        assert result.status == 1 and "ICD001" in result.err
        assert demo.read_bytes() == data

    def test_a_folder_means_its_icds_and_overlays(self, icdgen, demo):
        overlay = demo.parent / "errata" / "demo.yaml"
        overlay.parent.mkdir()
        overlay.write_text("node:   demo\nerrata: 1\nentries: []\n")
        icdgen("fmt", demo.parent)
        assert overlay.read_text().startswith("errata: 1\n")


CONSTANT = """messages:
  - name: Restart
    id: 33
    kind: telecommand
    length: 1
    fields:
      - {at: 0, bits: 8, name: Magic, type: uint, const: 0x5A}
"""


class TestDecode:
    def test_decode_prints_raw_and_physical_values_with_units_and_names(
        self, icdgen, demo
    ):
        out = icdgen("decode", "demo", "146", "2efb 01", "--icd", demo).out
        assert "-1234" in out and "-12.34" in out and "deg" in out and "Run" in out

    def test_json_for_programs(self, icdgen, demo):
        data = json.loads(
            icdgen(
                "decode",
                "demo",
                "Estimated Roll",
                "0x2E,0xFB,0x0D",
                "--icd",
                demo,
                "--format",
                "json",
            ).out
        )
        assert [field["raw"] for field in data["fields"]] == [-1234, 13]

    @pytest.mark.parametrize(
        "name", ["Estimated Roll", "estimated roll", "estimated_roll"]
    )
    def test_the_only_node_need_not_be_named(self, icdgen, demo, name):
        named = icdgen("decode", "demo", "Estimated Roll", "2efb 01", "--icd", demo).out
        assert icdgen("decode", name, "2efb 01", "--icd", demo).out == named
        assert icdgen("decode", name, "2e", "fb", "01", "--icd", demo).out == named
        assert (
            "`Estimated Roll`"
            in icdgen("decode", "Estimatd Roll", "2efb 01", "--icd", demo).err
        )

    def test_a_frame_from_a_file_hex_or_binary_and_from_standard_input(
        self, icdgen, demo, tmp_path, monkeypatch
    ):
        (tmp_path / "frame.hex").write_text("2e fb\n01\n")
        (tmp_path / "frame.bin").write_bytes(b"\x2e\xfb\x01")
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(b"2efb01")))
        outs = {
            icdgen("decode", "demo", "146", frame, "--icd", demo).out
            for frame in ("@frame.hex", "@frame.bin", "-")
        }
        assert len(outs) == 1

    @pytest.mark.parametrize(
        ("arguments", "words"),
        [
            (["demo", "146", "2efb"], "has 3 bytes, 2 given"),
            (["demo", "147", "2efb01"], "147"),
            (["demi", "146", "2efb01"], "demi"),
            (["demo", "146", "2exb01"], "x"),
            (["demo", "146", "@nowhere"], "cannot read nowhere"),
            (["demo", "99", "2efb01"], "demo has no message `99`"),
            (["demo", "9", "2e", "fb"], "demo has no message `9`"),
            (["demo", "146"], "there is no frame for Estimated Roll of demo"),
            (
                ["demo", "Estimated Roll"],
                "there is no frame for Estimated Roll of demo",
            ),
            (["demo", "Estimatd Roll?"], "demo has no message `Estimatd Roll?`"),
            (["demo", "147", "2e", "fb"], "demo has no message `147`"),
        ],
    )
    def test_a_mistake_is_reported(self, icdgen, demo, arguments, words):
        result = icdgen("decode", *arguments, "--icd", demo)
        assert (
            result.status == 2 and words in result.err and "Traceback" not in result.err
        )

    def test_a_frame_need_not_be_one_word_and_finds_its_message(self, icdgen, demo):
        outs = {
            icdgen("decode", *arguments, "--icd", demo).out
            for arguments in (
                ["demo", "146", "2e", "fb", "01"],
                ["demo", "146", "2efb01"],
                ["demo", "0x2efb01"],
            )
        }
        assert all("-12.34" in out for out in outs) and any(
            "found by its length" in out for out in outs
        )

    def test_the_only_node_need_not_be_named_before_an_id(self, icdgen, demo):
        named = icdgen("decode", "demo", "146", "2efb 01", "--icd", demo).out
        assert icdgen("decode", "146", "2efb 01", "--icd", demo).out == named
        assert (
            "has 3 bytes, 2 given" in icdgen("decode", "146", "2efb", "--icd", demo).err
        )

    def test_a_frame_in_words_of_decimal_digits_is_no_id(self, icdgen, demo):
        assert (
            "22 33 01" in icdgen("decode", "demo", "22", "33", "01", "--icd", demo).out
        )
        assert (
            "1122 3344"
            not in icdgen("decode", "demo", "1122", "3344", "--icd", demo).err
        )
        assert (
            "read as decimal numbers"
            in icdgen("decode", "demo", "146", "46", "251", "1", "--icd", demo).out
        )

    def test_a_number_that_is_no_id_is_read_as_a_byte_with_a_remark(self, icdgen, demo):
        out = icdgen("decode", "demo", "21", "fb", "01", "--icd", demo).out
        assert (
            "21 fb 01" in out
            and "demo has no message 21: it is taken for the first byte of the frame"
            in out
        )
        assert (
            "taken for"
            not in icdgen("decode", "demo", "2e", "fb", "01", "--icd", demo).out
        )

    def test_a_file_needs_no_sign_and_holds_any_number_of_frames(
        self, icdgen, demo, tmp_path
    ):
        (tmp_path / "frames.txt").write_text("92 2efb01\n92 000000\n")
        frames = json.loads(
            icdgen(
                "decode", "demo", "frames.txt", "--icd", demo, "--format", "json"
            ).out
        )
        assert [frame["fields"][0]["raw"] for frame in frames] == [-1234, 0]
        assert [frame["direction"] for frame in frames] == ["telemetry", "telemetry"]

    def test_csv_has_one_line_per_field(self, icdgen, demo):
        lines = icdgen(
            "decode", "demo", "146", "2efb01", "--icd", demo, "--format", "csv"
        ).out.splitlines()
        assert lines[0].startswith(
            "frame,node,message,direction,id,field,raw,value,unit"
        )
        assert (
            lines[1].startswith("0,demo,Estimated Roll,telemetry,,")
            and "-1234,-12.34,deg" in lines[1]
        )

    def test_a_wrong_constant_is_an_exit_status(self, icdgen, demo):
        demo.write_text(DEMO.replace("messages:\n", CONSTANT))
        assert icdgen("decode", "demo", "33", "5a", "--icd", demo).status == 0
        result = icdgen("decode", "demo", "33", "5b", "--icd", demo)
        assert result.status == 1 and "must be 90 (0x5A)" in result.out

    @pytest.mark.parametrize(
        ("arguments", "words"),
        [
            (["zz"], "`z` is not hexadecimal"),
            ([], "Missing argument"),
            (["demo"], "there is no frame for demo"),
            (["-", "demo"], "no node"),
        ],
    )
    def test_input_that_is_no_frame_is_reported(
        self, icdgen, demo, arguments, words, monkeypatch
    ):
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(b"")))
        result = icdgen("decode", *arguments, "--icd", demo)
        assert result.status == 2 and result.err.startswith("icdgen: error:"), result


class TestEncode:
    def test_encode_accepts_physical_values_by_short_names(self, icdgen, demo):
        assert (
            "2e fb"
            in icdgen("encode", "demo", "Set Roll", "roll=-12.34", "--icd", demo).out
        )

    def test_encode_accepts_raw_values(self, icdgen, demo):
        assert (
            "2e fb"
            in icdgen(
                "encode", "demo", "20", "Roll Angle=-1234", "--raw", "--icd", demo
            ).out
        )

    def test_values_out_of_range_are_refused(self, icdgen, demo):
        result = icdgen("encode", "demo", "20", "roll=400", "--icd", demo)
        assert result.status == 2 and "-327.68 to 327.67" in result.err


class TestShow:
    def test_json_has_the_stable_form(self, icdgen, demo):
        data = json.loads(icdgen("show", "--format", "json", "--icd", demo).out)
        message = data["nodes"][0]["messages"][0]
        assert {k: message[k] for k in ("name", "kind", "id", "length")} == {
            "name": "Estimated Roll", "kind": "telemetry", "id": 146, "length": 3,
        }  # fmt: skip
        assert message["fields"][0]["scale"] == "1/100"

    def test_a_message_for_people(self, icdgen, demo):
        assert "Roll Angle" in icdgen("show", "demo", "146", "--icd", demo).out

    @pytest.mark.parametrize("item", ["Set Roll", "146", "Mode"])
    def test_the_only_node_need_not_be_named(self, icdgen, demo, item):
        assert (
            icdgen("show", item, "--icd", demo).out
            == icdgen("show", "demo", item, "--icd", demo).out
        )


def test_an_icd_with_findings_stops_every_command_with_1(icdgen, demo):
    demo.write_text(DEMO.replace("length: 3", "length: 2"))
    for command in (
        ["show"],
        ["decode", "demo", "146", "00"],
        ["encode", "demo", "20"],
    ):
        result = icdgen(*command, "--icd", demo)
        assert result.status == 1 and "ICD020" in result.err


def test_help_and_version(icdgen):
    assert "generate" in icdgen("--help").out
    assert "icdgen, version" in icdgen("--version").out
