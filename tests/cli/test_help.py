"""`icdgen` alone prints the help, commands are in groups, and each has an example that
its options accept.
"""

from __future__ import annotations

import shlex

import click
import pytest

from icdgen.cli import icdgen as group

COMMANDS = group.list_commands(click.Context(group))


def test_icdgen_alone_prints_the_help_and_fails_without_a_configuration(
    icdgen,
):
    result = icdgen()
    assert (
        result.status == 2 and result.out == icdgen("--help").out and result.err == ""
    )


def test_icdgen_alone_generates_what_the_configuration_names(icdgen, demo, tmp_path):
    (tmp_path / "icdgen.toml").write_text('icds = ["icd"]\nlang = ["c"]\n')
    assert icdgen().status == 0 and (tmp_path / "generated" / "c" / "demo.h").is_file()


def test_commands_are_grouped_and_each_is_in_one_group(icdgen):
    text = icdgen("--help").out
    sections = [
        text.index(f"\n{title}:\n")
        for title in ("Describe a device", "Generate", "Talk to a device")
    ]
    assert sections == sorted(sections)
    assert [name for name in COMMANDS if text.count(f"\n  {name} ") != 1] == []


@pytest.mark.parametrize("name", COMMANDS)
def test_a_command_has_an_example_that_its_options_accept(name):
    parent = click.Context(group, **group.context_settings)
    command = group.get_command(parent, name)
    assert command is not None and command.epilog.startswith("Example: icdgen ")
    words = shlex.split(command.epilog.removeprefix("Example: icdgen "))
    arguments = words[1:] if words[0] == name else words
    command.make_context(name, arguments, parent=parent, resilient_parsing=True)
