"""Typed clients of framed links in C return each event as the message received.

The tests compile and run the examples of docs/reference/wire-framing.md.
"""

from __future__ import annotations

import subprocess

import pytest

from icdgen.loading import load
from tests import documents
from tests.c import harness
from tests.conformance.icds import LINKS, read_unchecked
from tests.conftest import ROOT

PAGE = documents.text("reference/wire-framing")
EXAMPLES = ROOT / "examples" / "links"


def documented_lines(begin: str) -> list[str]:
    """Return the lines of the documented example in C that begins with ``begin``."""
    _, following = PAGE.split(f"```c\n{begin}")
    return (begin + following.split("```")[0]).splitlines()


def run(folder, text, *icds):
    loaded = load(list(icds))
    assert loaded.findings == []
    headers = harness.generate(loaded.icd, folder / "made")
    source = folder / "program.c"
    source.write_text(text)
    for compiler in ("gcc", "clang"):
        flags = ("-std=c99", *harness.WARNINGS, *harness.SANITIZERS, f"-I{headers}")
        program = harness.compile(
            source, *flags, compiler=compiler, output=folder / "program"
        )
        done = subprocess.run([program], capture_output=True, text=True)
        assert (done.returncode, done.stderr) == (0, "")
    return done.stdout


DOCUMENTED = r"""
#include "receiver.h"
#include <assert.h>

static uint32_t clocks = 0;
static uint8_t wire[200];
static size_t on_wire = 0;

static void uart_write(const uint8_t *bytes, size_t count)
{
    memcpy(wire + on_wire, bytes, count);
    on_wire += count;
}

static void on_event(void *context, const icd_event_t *event)
{
    receiver_navigation_clock_t clock;
    (void)context;
    %s
}

int main(void)
{
    const uint32_t now = 0;
    static const uint8_t asked[] = {0xB5, 0x62, 0x01, 0x22, 0, 0, 0x23, 0x6A};
    void *const context = NULL;
    uint8_t input[RECEIVER_LINE_BYTES], data[RECEIVER_NAVIGATION_CLOCK_LENGTH] = {0};
    receiver_set_message_rate_t rate;
    size_t count = 0, n = 0;
    receiver_set_message_rate_init(&rate);
    rate.rate = 1;
    assert(icd_stream_encode(
        receiver_link(), ICD_TELEMETRY, RECEIVER_NAVIGATION_CLOCK_ID, data, sizeof data, NULL, input, sizeof input, &n) == ICD_OK);
    %s
    assert(on_wire == sizeof asked + RECEIVER_SET_MESSAGE_RATE_LENGTH + 8u && memcmp(wire, asked, sizeof asked) == 0);
    assert(clocks == 1u && !icd_client_deadline(&receiver.client, &clocks));
    return 0;
}
"""


def test_the_documented_client_requests_sends_and_receives_messages(tmp_path):
    lines = documented_lines("receiver_client_t receiver;")
    in_event = [line.replace("...", "++clocks;") for line in lines if "{ ... }" in line]
    in_main = [line for line in lines if "{ ... }" not in line]
    assert len(in_event) == 1 and len(in_main) > 7
    program = DOCUMENTED % (in_event[0], "\n    ".join(in_main))
    run(tmp_path, program, EXAMPLES / "ubx.yaml")


WHEEL = r"""
#include "wheel.h"
#include <assert.h>
#include <stdio.h>

static void uart_write(const uint8_t *bytes, size_t count)
{
    printf("> ");
    for (size_t i = 3; i + 2u < count; ++i) {
        printf("%%02x", (unsigned)bytes[i]);
    }
    printf("\n");
}

%s

static wheel_client_t wheel;

static void responds(uint32_t now, uint32_t id, const char *data, size_t length)
{
    uint8_t line[WHEEL_LINE_BYTES];
    size_t count = 0;
    assert(icd_stream_encode(
        wheel_link(), ICD_TELEMETRY, id, (const uint8_t *)data, length, NULL, line, sizeof line, &count) == ICD_OK);
    step(&wheel, now, line, count);
}

int main(void)
{
    static uint8_t buffer[WHEEL_CLIENT_BYTES + WHEEL_REQUEST_BYTES];
    static icd_slot_t slots[2];
    wheel_set_speed_t speed;
    uint32_t deadline = 0;
    assert(wheel_client_init(&wheel, slots, 2, buffer, sizeof buffer) == ICD_OK);
    wheel_set_speed_init(&speed);
    speed.speed = 0x010203;
    assert(wheel_send_set_speed(&wheel, 0, &speed) == ICD_OK && wheel_request_events(&wheel, 0) == ICD_OK);
    step(&wheel, 0, NULL, 0);
    responds(10, WHEEL_NAK_ID, "\x02\x04", 2);
    responds(20, WHEEL_EVENTS_ID, "\x00\x07", 2);
    assert(wheel_send_save(&wheel, 30) == ICD_OK && wheel_send_set_speed(&wheel, 30, &speed) == ICD_OK);
    step(&wheel, 30, NULL, 0);
    responds(40, WHEEL_BUSY_ID, "\x05", 1);
    while (icd_client_deadline(&wheel.client, &deadline)) {
        step(&wheel, deadline, NULL, 0);
        if (deadline == 140) {
            responds(150, WHEEL_ACK_ID, "\x05", 1);
        }
    }
    return 0;
}
"""
OUTCOMES = [
    "> 02010203", "refused: set the mode first", "> 04", "7 events", "> 05", "> 05", "> 02010203",
    "no response, 1 attempts",
]  # fmt: skip


def test_the_documented_program_reports_how_each_command_of_the_wheel_ends(tmp_path):
    lines = "\n".join(documented_lines("static void on_event(void *context"))
    output = run(tmp_path, WHEEL % lines, EXAMPLES / "wheel.yaml")
    assert output.splitlines() == OUTCOMES


ARM = r"""
#include "arm.h"
#include <assert.h>

static arm_client_t arm;
static icd_slot_t slots[3];
static uint8_t buffer[ARM_CLIENT_BYTES + 2u * ARM_REQUEST_BYTES];
static char seen[200];

static void on_event(void *context, const icd_event_t *event)
{
    arm_position_t position;
    arm_command_result_t result;
    (void)context;
    strcat(seen, event->kind == ICD_EVENT_REPLY ? "reply" : event->kind == ICD_EVENT_DONE ? "done"
        : event->kind == ICD_EVENT_REFUSED ? "refused" : event->kind == ICD_EVENT_TIMEOUT ? "timeout"
        : event->kind == ICD_EVENT_LATE ? "late" : event->kind == ICD_EVENT_STRAY ? "stray" : "?");
    if (arm_receive_position(&position, event) == ICD_OK) {
        strcat(seen, position.angle == 0x0302 ? " position" : "?");
    }
    if (arm_receive_command_result(&result, event) == ICD_OK) {
        strcat(seen, result.number == event->data[3] ? " result" : "?");
    }
    if (event->has_code) {
        assert(event->kind == ICD_EVENT_REFUSED && event->code == ARM_DETAIL_BLOCKED);
        strcat(seen, " blocked");
    }
    strcat(seen, "; ");
    if (event->kind == ICD_EVENT_REFUSED) { /* a callback may cancel and start requests */
        arm_move_joint_t move;
        arm_move_joint_init(&move);
        icd_client_cancel(&arm.client);
        assert(arm_send_move_joint(&arm, 70, &move) == ICD_OK);
    }
}

static bool is_sent(uint32_t id)
{
    uint8_t line[ARM_LINE_BYTES];
    size_t count = 0;
    const bool is_output = icd_client_output(&arm.client, line, sizeof line, &count);
    return is_output && (((uint32_t)line[1] << 8) | line[2]) == id;
}

static void responds(uint32_t now, uint32_t id, uint8_t first, uint8_t second, uint8_t third, uint8_t fourth)
{
    static uint8_t sequence = 0;
    const uint8_t data[6] = {first, second, third, fourth, 0, 0};
    const size_t length = id == ARM_POSITION_ID ? ARM_POSITION_LENGTH : ARM_COMMAND_RESULT_LENGTH;
    icd_header_values_t values = icd_header_values(arm_link(), ICD_TELEMETRY);
    uint8_t line[ARM_LINE_BYTES];
    size_t count = 0;
    values.of[ICD_FIELD_SEQUENCE] = sequence++;
    assert(icd_stream_encode(arm_link(), ICD_TELEMETRY, id, data, length, &values, line, sizeof line, &count) == ICD_OK);
    icd_client_received(&arm.client, now, line, count, on_event, NULL);
}

int main(void)
{
    const uint32_t long_after = UINT32_C(0x90000000); /* the clock passed half its range while the client was idle */
    arm_read_position_t read;
    arm_move_joint_t move;
    uint32_t deadline = 0;
    arm_read_position_init(&read);
    arm_move_joint_init(&move);
    read.joint = 1;
    assert(arm_client_init(&arm, slots, 3, buffer, sizeof buffer) == ICD_OK);
    arm.client.settings.gap = 5;

    assert(arm_send_read_position(&arm, 0, &read) == ICD_OK && is_sent(ARM_READ_POSITION_ID));
    responds(10, ARM_POSITION_ID, 1, 2, 3, 0);
    responds(20, ARM_COMMAND_RESULT_ID, 0, 0, 2, 5);
    responds(30, ARM_COMMAND_RESULT_ID, 0, 0, 2, 5);
    assert(strcmp(seen, "reply position; done result; stray result; ") == 0);

    seen[0] = '\0';
    assert(arm_send_read_position(&arm, 40, &read) == ICD_OK && is_sent(ARM_READ_POSITION_ID));
    assert(arm_send_move_joint(&arm, 45, &move) == ICD_OK && is_sent(ARM_MOVE_JOINT_ID));
    responds(60, ARM_COMMAND_RESULT_ID, 0xC3, 0x2B, 2, 5); /* failed, 700 */
    assert(strcmp(seen, "refused result blocked; ") == 0);
    assert(icd_client_deadline(&arm.client, &deadline) && !is_sent(ARM_MOVE_JOINT_ID)); /* it may be late */
    responds(80, ARM_COMMAND_RESULT_ID, 0, 0, 2, 1);
    assert(strcmp(seen, "refused result blocked; late result; ") == 0 && is_sent(ARM_MOVE_JOINT_ID));

    seen[0] = '\0';
    while (icd_client_deadline(&arm.client, &deadline)) {
        icd_client_tick(&arm.client, deadline, on_event, NULL);
    }
    assert(strcmp(seen, "timeout; ") == 0);
    assert(arm_send_move_joint(&arm, long_after, &move) == ICD_OK && is_sent(ARM_MOVE_JOINT_ID));
    return 0;
}
"""


def test_responses_before_and_after_the_time_out_are_distinguished(tmp_path):
    run(tmp_path, ARM, LINKS / "outcomes.yaml")


SENDING = r"""
#include "autopilot.h"
#include <assert.h>

int main(void)
{
    uint8_t line[AUTOPILOT_LINE_BYTES];
    autopilot_set_mode_t mode;
    size_t written = 0;
    autopilot_set_mode_init(&mode);
    %s
    assert(line[4] == 0u && line[5] == 9u);
    mode.custom_mode = 7;
    assert(autopilot_put_set_mode(&sender, &mode, line, 3u, &written) == ICD_ERROR_LENGTH);
    assert(autopilot_put_set_mode(&sender, &mode, line, sizeof line, &written) == ICD_OK && line[4] == 1u);
    assert(line[1] == 1u && line[10] == 7u && written == 13u); /* zeros at the end are not sent */
    return 0;
}
"""


def test_the_documented_sender_numbers_its_packets(tmp_path):
    run(
        tmp_path,
        SENDING % "\n    ".join(documented_lines("autopilot_sender_t sender;")),
        EXAMPLES / "mavlink2.yaml",
    )


SHARED = r"""
#include "datagram.h"
#include <assert.h>

typedef struct {
    icd_status_t shorter, first, another;
    uint32_t level;
    icd_event_kind_t kind;
} seen_t;

static void on_event(void *context, const icd_event_t *event)
{
    seen_t *const seen = (seen_t *)context;
    datagram_short_level_t shorter = {0};
    datagram_level_of_the_first_t first = {0};
    datagram_level_of_another_t another = {0};
    icd_event_t elsewhere = *event;
    elsewhere.link = NULL;
    seen->kind = event->kind;
    seen->shorter = datagram_receive_short_level(&shorter, event);
    seen->first = datagram_receive_level_of_the_first(&first, event);
    seen->another = datagram_receive_level_of_another(&another, event);
    seen->level = first.level;
    assert(datagram_receive_level_of_the_first(&first, &elsewhere) == ICD_ERROR_UNKNOWN_ID);
}

static seen_t comes(datagram_client_t *client, const uint8_t *data, size_t length)
{
    uint8_t line[DATAGRAM_LINE_BYTES];
    size_t count = 0;
    seen_t seen = {ICD_OK, ICD_OK, ICD_OK, 0u, ICD_EVENT_GAP};
    assert(icd_stream_encode(
        datagram_link(), ICD_TELEMETRY, DATAGRAM_SHORT_LEVEL_ID, data, length, NULL, line, sizeof line, &count) == ICD_OK);
    icd_client_received(&client->client, 1, line, count, on_event, &seen);
    return seen;
}

int main(void)
{
    static datagram_client_t client;
    static uint8_t buffer[DATAGRAM_CLIENT_BYTES + DATAGRAM_REQUEST_BYTES], line[DATAGRAM_LINE_BYTES];
    static const uint8_t first[] = {1, 2, 3}, another[] = {2, 2, 3};
    icd_slot_t slots[2];
    datagram_order_t order;
    datagram_points_t points;
    size_t count = 0;
    datagram_order_init(&order);
    datagram_points_init(&points);
    points.points_count = 2;
    assert(datagram_client_init(&client, slots, 2, buffer, sizeof buffer - 1u) == ICD_ERROR_LENGTH);
    assert(datagram_send_order(&client, 0, &order) == ICD_ERROR_UNSUPPORTED);
    assert(datagram_client_init(&client, slots, 2, buffer, sizeof buffer) == ICD_OK);
    client.client.settings.in_flight = 2;

    assert(datagram_ask_order(&client, 0, &order, DATAGRAM_SHORT_LEVEL_ID) == ICD_OK);
    assert(datagram_ask_points(&client, 0, &points, DATAGRAM_ORDER_ID) == ICD_ERROR_UNKNOWN_ID);
    assert(datagram_ask_points(&client, 0, &points, DATAGRAM_LEAST_ID) == ICD_OK);
    assert(datagram_ask_points(&client, 0, &points, DATAGRAM_LEAST_ID) == ICD_ERROR_BUSY);
    assert(icd_client_output(&client.client, line, sizeof line, &count));
    assert(icd_client_output(&client.client, line, sizeof line, &count));
    assert(count == 10u + 5u + 6u); /* two points are five bytes, around them header and trailer */

    seen_t seen = comes(&client, first, sizeof first);
    assert(seen.kind == ICD_EVENT_DONE && seen.first == ICD_OK && seen.level == 0x203u);
    assert(seen.shorter == ICD_ERROR_UNKNOWN_ID && seen.another == ICD_ERROR_UNKNOWN_ID);
    seen = comes(&client, another, sizeof another);
    assert(seen.kind == ICD_EVENT_ARRIVED && seen.another == ICD_OK);
    assert(seen.shorter == ICD_ERROR_UNKNOWN_ID && seen.first == ICD_ERROR_UNKNOWN_ID);
    seen = comes(&client, first, 1);
    assert(seen.shorter == ICD_OK && seen.another == ICD_ERROR_UNKNOWN_ID && seen.first == ICD_ERROR_UNKNOWN_ID);
    return 0;
}
"""


def test_an_event_is_read_only_as_the_message_that_was_received(tmp_path):
    run(tmp_path, SHARED, LINKS / "packets.yaml")


@pytest.mark.parametrize("compiler, standard", [("gcc", "c99"), ("g++", "c++17")])
def test_clients_of_all_links_compile_under_all_warnings(tmp_path, compiler, standard):
    icd = read_unchecked(
        *sorted(LINKS.glob("*.yaml")), *sorted(EXAMPLES.glob("*.yaml"))
    )
    harness.compile_all(icd, harness.generate(icd, tmp_path), compiler, standard)


CALL = """\
#include "datagram.h"
#include "receiver.h"
icd_status_t call(receiver_client_t *client, const receiver_set_message_rate_t *rate);
icd_status_t call(receiver_client_t *client, const receiver_set_message_rate_t *rate)
{
    (void)client;
    (void)rate;
    return %s;
}
"""
CALLS = {
    "receiver_send_set_message_rate(client, 0, rate)": 0,
    "datagram_send_order(client, 0, rate)": 1,
    "receiver_send_poll_clock(&client->client, 0)": 1,
    "receiver_request_end_of_epoch(client, 0)": 1,  # no telecommand asks for it
}


@pytest.fixture(scope="module")
def two_links(tmp_path_factory):
    icd = read_unchecked(LINKS / "packets.yaml", EXAMPLES / "ubx.yaml")
    return harness.generate(icd, tmp_path_factory.mktemp("two_links"))


@pytest.mark.parametrize("call", CALLS)
def test_only_calls_for_messages_of_the_node_compile(two_links, tmp_path, call):
    source = tmp_path / "call.c"
    source.write_text(CALL % call)
    done = subprocess.run(
        ["gcc", "-std=c99", "-Werror", "-fsyntax-only", f"-I{two_links}", source],
        capture_output=True,
    )
    assert done.returncode == CALLS[call], done.stderr


BATTERY = r"""
#include "jbd.h"
#include <assert.h>
#include <stdio.h>

static jbd_client_t battery;

static void on_event(void *context, const icd_event_t *event)
{
    jbd_basic_information_t information;
    jbd_status_t status = 0;
    (void)context;
    printf("%s %x", event->kind == ICD_EVENT_DONE ? "done" : event->kind == ICD_EVENT_REFUSED ? "refused"
        : event->kind == ICD_EVENT_STRAY ? "stray" : "?", (unsigned)event->id);
    if (jbd_receive_basic_information(&information, event) == ICD_OK) {
        printf(": %u mV, %u sensors", 10u * information.total_voltage, (unsigned)information.sensors);
    }
    if (jbd_refusal(event, &status)) {
        printf(": status %x", (unsigned)status);
    }
    printf(event->is_packet ? ", a packet of %u bytes\n" : "\n", (unsigned)event->length);
}

static void sends(void)
{
    uint8_t line[JBD_LINE_BYTES];
    size_t count = 0;
    while (icd_client_output(&battery.client, line, sizeof line, &count)) {
        printf("> ");
        for (size_t i = 0; i < count; ++i) {
            printf("%02x", (unsigned)line[i]);
        }
        printf("\n");
    }
}

static void responds(uint32_t now, const char *bytes, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        const uint8_t byte = (uint8_t)bytes[i];
        icd_client_received(&battery.client, now, &byte, 1, on_event, NULL);
    }
    sends();
}

int main(void)
{
    static uint8_t buffer[JBD_CLIENT_BYTES + JBD_REQUEST_BYTES];
    static icd_slot_t slots[2];
    static const char information[] =
        "\xDD\x03\x00\x1B\x17\x00\x00\x00\x02\xD0\x03\xE8\x00\x00\x20\x78\x00\x00\x00\x00\x00\x00\x10\x48\x03\x0F\x02"
        "\x0B\x76\x0B\x82\xFB\xFF\x77";
    jbd_switch_off_t command;
    assert(jbd_client_init(&battery, slots, 2, buffer, sizeof buffer) == ICD_OK);
    jbd_switch_off_init(&command);
    command.switches = 2;
    assert(jbd_request_basic_information(&battery, 0) == ICD_OK);
    sends();
    responds(10, information, sizeof information - 1u);
    assert(jbd_send_switch_off(&battery, 20, &command) == ICD_OK);
    sends();
    responds(30, "\xDD\xE1\x00\x00\x00\x00\x77", 7);
    assert(jbd_send_switch_off(&battery, 40, &command) == ICD_OK);
    assert(jbd_request_cell_voltages(&battery, 40) == ICD_OK);
    sends();
    responds(50, "\xDD\x04\x80\x00\xFF\x80\x77", 7); /* of another request */
    responds(60, "\xDD\xE1\x80\x00\xFF\x80\x77", 7);
    responds(70, "\xDD\x04\x80\x00\xFF\x80\x77", 7);
    return 0;
}
"""
OF_BATTERY = [
    "> dda50300fffd77",
    "done 3: 58880 mV, 2 sensors",
    "> dd5ae1020002ff1b77",
    "done e1",
    "> dd5ae1020002ff1b77",
    "stray 4, a packet of 7 bytes",
    "refused e1: status 80, a packet of 7 bytes",
    "> dda50400fffc77",
    "refused 4: status 80, a packet of 7 bytes",
]


def test_a_battery_responds_with_packets_of_several_formats(tmp_path):
    assert run(tmp_path, BATTERY, EXAMPLES / "jbd.yaml").splitlines() == OF_BATTERY
