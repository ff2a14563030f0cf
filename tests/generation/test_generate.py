"""A run of the generator: its plans, its dependency file and what it remembers."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from icdgen import backends, cache
from icdgen.errors import UserError
from icdgen.generation import generate, manifest
from icdgen.generation.generate import GenerationOutcome, Job, _escape, remember, run
from tests.conftest import DEMO


@pytest.fixture
def job(demo, tmp_path) -> Job:
    return Job(["python"], tmp_path / "out", [demo])


def test_equal_languages_are_generated_once_and_into_the_folder_itself(job):
    job.languages = ["python", "python"]
    outcome = run(job)
    assert [(plan.language, plan.out) for plan in outcome.plans] == [
        ("python", job.out)
    ]
    assert outcome.changes and outcome.may_be_remembered
    assert set(outcome.plans[0].write) == set(outcome.plans[0].files)
    assert all((job.out / name).is_file() for name in outcome.plans[0].files)
    assert not run(job).changes


def test_several_languages_have_subfolders_in_the_given_order(job):
    job.languages = ["rust", "python", "rust"]
    outcome = run(job)
    assert [(plan.language, plan.out) for plan in outcome.plans] == [
        ("rust", job.out / "rust"),
        ("python", job.out / "python"),
    ]


def test_a_check_writes_nothing_and_knows_the_changes(job, tmp_path):
    job.check, job.depfile = True, tmp_path / "out.d"
    assert run(job).changes
    assert not job.out.exists() and not job.depfile.exists()
    job.check = False
    run(job)
    job.check = True
    assert not run(job).changes


def test_an_icd_with_an_error_has_no_plan(job, demo):
    demo.write_text(DEMO.replace("length: 3", "length: 2"))
    outcome = run(job)
    assert (outcome.plans, outcome.inputs, outcome.changes) == ([], {}, False)
    assert not job.out.exists()


def test_every_file_passes_through_the_watcher_once(job):
    seen: list[str] = []

    def watch(files):
        for path, content in files:
            seen.append(str(path))
            yield path, content

    job.watch = watch
    (plan,) = run(job).plans
    assert sorted(seen) == sorted(map(str, plan.files)) and len(seen) == len(set(seen))


def test_the_inputs_are_the_icds_the_configuration_and_the_templates(
    job, demo, tmp_path
):
    config = tmp_path / "icdgen.toml"
    job.configs = {config: ""}
    outcome = run(job)
    assert {demo, config} <= {Path(path) for path in outcome.inputs}
    job.templates = tmp_path / "templates"
    (job.templates / "python").mkdir(parents=True)
    replaced = run(job).inputs.keys() - outcome.inputs.keys()
    assert replaced
    assert all(Path(path).is_relative_to(job.templates) for path in replaced)


@pytest.mark.parametrize(
    ("options", "text", "help"),
    [
        (
            {"templates": Path("none")},
            "there is no folder none",
            "--templates names a folder of templates",
        ),
        (
            {"measured": Path(".")},
            "measurements go into the assurance pack only",
            "add `--lang assurance`, or leave --measured out",
        ),
    ],
)
def test_options_that_cannot_apply_are_refused_before_anything_is_written(
    job, options, text, help
):
    for name, value in options.items():
        setattr(job, name, value)
    with pytest.raises(UserError) as error:
        run(job)
    assert (str(error.value), error.value.help) == (text, help)
    assert not job.out.exists()


def test_measurements_go_to_the_backend_that_takes_them(job, tmp_path):
    job.languages, job.measured = ["assurance"], tmp_path
    outcome = run(job)
    assert outcome.plans[0].language == "assurance"
    assert backends.get("assurance").measured is None or outcome.changes


@pytest.mark.parametrize(
    ("path", "expected"),
    [
        ("a/b.yaml", "a/b.yaml"),
        ("my icds", r"my\ icds"),
        ("a#b", r"a\#b"),
        ("a$b", "a$$b"),
        ("a:b", r"a\:b"),
        (r"a\b", r"a\\b"),
        (r"a\ b", r"a\\\ b"),
    ],
)
def test_a_path_is_escaped_for_make(path, expected):
    assert _escape(path) == expected


def test_a_path_with_a_line_break_is_refused():
    with pytest.raises(UserError) as error:
        _escape("a\nb")
    assert str(error.value) == "a\nb cannot be named in a dependency file"
    assert error.value.help == "rename what has a line end in its name"


def test_a_dependency_file_has_a_line_for_each_output_and_existing_input(job, tmp_path):
    job.depfile = tmp_path / "out.d"
    job.configs = {tmp_path / "absent.toml": ""}
    outcome = run(job)
    (plan,) = outcome.plans
    outputs, _, inputs = job.depfile.read_text().partition(": \\\n  ")
    assert outputs.split(" \\\n  ") == [f"{job.out}/{name}" for name in plan.files]
    existing = [str(path) for path in outcome.inputs if path.is_file()]
    assert inputs == " \\\n  ".join(map(_escape, existing)) + "\n"
    assert "absent.toml" not in inputs


def test_an_equal_dependency_file_is_not_written_again(job, tmp_path):
    job.depfile = tmp_path / "out.d"
    run(job)
    os.utime(job.depfile, ns=(5, 5))
    run(job)
    assert job.depfile.stat().st_mtime_ns == 5
    job.depfile.write_text("other")
    run(job)
    assert job.depfile.read_text() != "other"


def test_the_dependency_file_is_neither_an_input_nor_an_output(job, demo, tmp_path):
    name = next(iter(run(job).plans[0].files))
    (tmp_path / "link").symlink_to(demo)
    for path in (demo, tmp_path / "link", job.out / name):
        job.depfile = path
        before = path.read_bytes()
        with pytest.raises(UserError) as error:
            run(job)
        assert str(error.value) == f"{path} is an input or an output"
        assert error.value.help == "give the dependency file a name of its own"
        assert path.read_bytes() == before
    (tmp_path / "file").touch()
    job.depfile = tmp_path / "file" / "out.d"
    with pytest.raises(UserError, match=r"cannot write .*out\.d") as error:
        run(job)
    assert error.value.help == "choose another place for it"


@pytest.fixture
def remembered(monkeypatch):
    """Return the calls that store a record of a run."""
    calls: list[tuple] = []
    monkeypatch.setattr(cache, "remember", lambda *arguments: calls.append(arguments))
    return calls


def test_a_run_is_remembered_with_its_inputs_and_outputs(
    job, demo, tmp_path, remembered
):
    job.depfile = tmp_path / "out.d"
    outcome = run(job)
    remembered.clear()
    remember("name", "nöte", job, outcome)
    ((kind, name, note, files),) = remembered
    assert (kind, name, note.decode()) == ("runs", "name", "nöte")
    (plan,) = outcome.plans
    outputs = {str(job.out / file): digest for file, digest in plan.digests.items()}
    inputs = {os.path.abspath(path): mark for path, mark in outcome.inputs.items()}
    own = {
        str(manifest.path(job.out, "python")): manifest.digest(plan.manifest.encode()),
        str(job.depfile): manifest.digest(job.depfile.read_bytes()),
    }
    assert files == inputs | outputs | own
    assert str(demo) in files
    job.check = True
    remember("name", "", job, outcome)
    assert str(job.depfile) not in remembered[-1][3]


def test_a_run_that_may_differ_next_time_is_not_remembered(job, demo, remembered):
    outcome = run(job)
    remembered.clear()
    remember("", "note", job, outcome)
    outcome.may_be_remembered = False
    remember("name", "note", job, outcome)
    outcome.may_be_remembered = True
    outcome.loaded.findings.append(object())
    remember("name", "note", job, outcome)
    assert remembered == []


def test_an_outcome_without_plans_changes_nothing():
    assert not GenerationOutcome(None).changes
    assert generate.run is run
