"""Code on the page of a message: reception and transmission of one field."""

from __future__ import annotations

import pytest

from icdgen import backends
from icdgen.backends.html import usage
from icdgen.backends.packages import Packages
from icdgen.describe import describe
from icdgen.render import Renderer
from tests.icd.files import loaded

RENDER = Renderer.of_backend(backends.get("html"))
ICD = """\
enums:
  - {name: Work Mode, members: [{value: 0, name: Idle}, {value: 2, name: Run}]}
messages:
  - {name: Stop, id: 1, kind: telecommand, length: 0}
  - {name: Alive, id: 200, kind: telemetry, length: 0}
  - {name: Mode, set_id: 3, get_id: 203, kind: configuration, length: 1, fields: [
      {at: 0, bits: 8, name: Type, type: enum, enum: Work Mode}]}
  - {name: Light, id: 4, kind: telecommand, length: 1, fields: [
      {at: 0, bits: 1, name: Lamp, type: bool}]}
  - {name: Scaled, set_id: 6, get_id: 206, kind: configuration, length: 1, fields: [
      {at: 0, bits: 8, name: Level, type: int, unit: C, formula: raw*0.5}]}
  - {name: Items, id: 7, kind: telecommand, length: 1, fields: [
      {at: 0, bits: 8, name: Count, type: uint},
      {at: 8, bits: 8, name: Items, type: uint, count: Count, up_to: 3}]}
  - {name: Square, set_id: 8, get_id: 208, kind: configuration, length: 1, fields: [
      {at: 0, bits: 8, name: Level, type: uint, formula: raw^2 - 9*raw}]}
  - {name: Rate, id: 5, kind: telecommand, length: 4, fields: [
      {at: 0, bits: 32, name: Rate, type: float}]}
"""
C = {
    "Stop": """\
demo_stop_t message;
uint8_t frame[DEMO_STOP_LENGTH + 1];

demo_stop_init(&message);
if (demo_stop_encode(&message, frame, sizeof frame) == ICD_OK) {
    send(DEMO_STOP_ID, frame, DEMO_STOP_LENGTH);
}""",
    "Alive": """\
demo_alive_t message;
if (demo_alive_decode(&message, buffer, length) == ICD_OK) {
    /* the message has no fields */
}""",
    "Mode": """\
demo_mode_t message;
if (demo_mode_decode(&message, buffer, length) == ICD_OK) {
    use(message.type);
}

demo_mode_t command;
uint8_t frame[DEMO_MODE_LENGTH];

demo_mode_init(&command);
command.type = DEMO_WORK_MODE_RUN;
if (demo_mode_encode(&command, frame, sizeof frame) == ICD_OK) {
    send(DEMO_MODE_SET_ID, frame, DEMO_MODE_LENGTH);
}""",
    "Light": """\
demo_light_t message;
uint8_t frame[DEMO_LIGHT_LENGTH];

demo_light_init(&message);
message.lamp = false;
if (demo_light_encode(&message, frame, sizeof frame) == ICD_OK) {
    send(DEMO_LIGHT_ID, frame, DEMO_LIGHT_LENGTH);
}""",
    "Scaled": """\
demo_scaled_t message;
if (demo_scaled_decode(&message, buffer, length) == ICD_OK) {
    double level = demo_scaled_level_c(&message);
}

demo_scaled_t command;
uint8_t frame[DEMO_SCALED_LENGTH];

demo_scaled_init(&command);
demo_scaled_set_level_c(&command, 0.0);   /* ICD_OK, unless it does not fit */
if (demo_scaled_encode(&command, frame, sizeof frame) == ICD_OK) {
    send(DEMO_SCALED_SET_ID, frame, DEMO_SCALED_LENGTH);
}""",
    "Items": """\
demo_items_t message;
uint8_t frame[DEMO_ITEMS_LENGTH];

demo_items_init(&message);
if (demo_items_encode(&message, frame, sizeof frame) == ICD_OK) {
    send(DEMO_ITEMS_ID, frame, demo_items_size(&message));
}""",
    "Square": """\
demo_square_t message;
if (demo_square_decode(&message, buffer, length) == ICD_OK) {
    double level = demo_square_level_physical(&message);
}

demo_square_t command;
uint8_t frame[DEMO_SQUARE_LENGTH];

demo_square_init(&command);
command.level = 0;
if (demo_square_encode(&command, frame, sizeof frame) == ICD_OK) {
    send(DEMO_SQUARE_SET_ID, frame, DEMO_SQUARE_LENGTH);
}""",
}
PYTHON = {
    "Stop": """\
from py.demo import Stop

command = Stop()
send(Stop.ID, command.to_bytes())""",
    "Alive": """\
from py.demo import Alive

message = Alive.from_bytes(buffer)""",
    "Mode": """\
from py.demo import Mode, WorkMode

message = Mode.from_bytes(buffer)
message.type

command = Mode()
command.type = WorkMode.RUN
send(Mode.SET_ID, command.to_bytes())""",
    "Light": """\
from py.demo import Light

command = Light()
command.lamp = False
send(Light.ID, command.to_bytes())""",
    "Scaled": """\
from py.demo import Scaled

message = Scaled.from_bytes(buffer)
message.level   # raw
message.level_c   # physical

command = Scaled()
command.level_c = 0.0   # RangeError, if it does not fit
send(Scaled.SET_ID, command.to_bytes())""",
    # The physical value of a formula without inverse can only be read.
    "Square": """\
from py.demo import Square

message = Square.from_bytes(buffer)
message.level   # raw
message.level_physical   # physical

command = Square()
command.level = 0
send(Square.SET_ID, command.to_bytes())""",
    "Rate": """\
from py.demo import Rate

command = Rate()
command.rate = 0.0
send(Rate.ID, command.to_bytes())""",
}
RUST = {
    "Stop": """\
use rs::demo::Stop;

let command = Stop::default();
send(Stop::ID, &command.to_bytes()?);""",
    "Alive": """\
use rs::demo::Alive;

let _message = Alive::from_bytes(buffer)?;""",
    "Mode": """\
use rs::demo::Mode;
use rs::demo::enums::WorkMode;

let message = Mode::from_bytes(buffer)?;
let r#type = message.r#type;

let mut command = Mode::default();
command.r#type = WorkMode::Run.into();
send(Mode::SET_ID, &command.to_bytes()?);""",
    "Light": """\
use rs::demo::Light;

let mut command = Light::default();
command.lamp = false;
send(Light::ID, &command.to_bytes()?);""",
    "Scaled": """\
use rs::demo::Scaled;

let message = Scaled::from_bytes(buffer)?;
let level = message.level_c();

let mut command = Scaled::default();
command.set_level_c(0.0)?;   // refuses what does not fit
send(Scaled::SET_ID, &command.to_bytes()?);""",
    "Square": """\
use rs::demo::Square;

let message = Square::from_bytes(buffer)?;
let level = message.level_physical();

let mut command = Square::default();
command.level = 0;
send(Square::SET_ID, &command.to_bytes()?);""",
    "Rate": """\
use rs::demo::Rate;

let mut command = Rate::default();
command.rate = 0.0;
send(Rate::ID, &command.to_bytes()?);""",
}


@pytest.mark.parametrize(
    ("key", "language", "texts"),
    [("c", "C", C), ("python", "Python", PYTHON), ("rust", "Rust", RUST)],
)
def test_a_snippet_receives_and_sends_one_field(tmp_path, key, language, texts):
    (node,) = describe(loaded(tmp_path, ICD).icd).nodes
    packages = Packages(python="py", rust="rs")
    shown = {}
    for message in node.messages:
        snippets = usage.snippets(message, message, packages, RENDER)
        assert [snippet.key for snippet in snippets] == ["c", "python", "rust"]
        (snippet,) = (each for each in snippets if each.key == key)
        assert snippet.language == language
        if message.model.name in texts:
            shown[message.model.name] = snippet.text
    head = '#include "demo.h"\n\n' if key == "c" else ""
    assert shown == {name: head + text for name, text in texts.items()}
