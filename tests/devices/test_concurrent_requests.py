"""The clients of C and Rust complete two concurrent requests on a framed link, also if
a response is lost.

The programs contain the examples of docs/reference/wire-framing.md.
"""

from __future__ import annotations

import re
import subprocess

from tests import documents
from tests.c import harness as c
from tests.conformance.icds import icd_of
from tests.conftest import ROOT
from tests.rust import harness as rust
from tests.rust.tools import USED, Toolchain, run

ICD = icd_of([ROOT / "examples" / "links" / "ubx.yaml"])
SHOWN = documents.text("reference/wire-framing").split("## Client\n")[1]

C = """
#include "receiver.h"
#include <stdio.h>

static void on_event(void *context, const icd_event_t *event)
{
    receiver_navigation_clock_t clock;
    const unsigned long id = event->id;
    (void)context;
    if (event->kind == ICD_EVENT_TIMEOUT) {
        (void)printf("timeout %%lu\\n", id);
    }
    if (event->kind == ICD_EVENT_SENT) {
        (void)printf("sent %%lu\\n", id);
    }
    if (receiver_receive_navigation_clock(&clock, event) == ICD_OK) {
        (void)printf(
            "%%s %%lu %%ld\\n", event->kind == ICD_EVENT_DONE ? "done" : "late", id, (long)clock.clock_bias);
    }
}

static size_t answer(uint8_t *line, size_t capacity, int32_t bias)
{
    receiver_navigation_clock_t clock;
    uint8_t data[RECEIVER_NAVIGATION_CLOCK_LENGTH];
    size_t count = 0;
    receiver_navigation_clock_init(&clock);
    clock.clock_bias = bias;
    (void)receiver_navigation_clock_encode(&clock, data, sizeof data);
    (void)icd_stream_encode(
        receiver_link(), ICD_TELEMETRY, RECEIVER_NAVIGATION_CLOCK_ID, data, sizeof data, NULL, line, capacity, &count);
    return count;
}

static void send(icd_client_t *client)
{
    uint8_t line[RECEIVER_LINE_BYTES];
    size_t count = 0;
    while (icd_client_output(client, line, sizeof line, &count)) {
        (void)printf("sent %%02x%%02x %%lu\\n", line[2], line[3], (unsigned long)count);
    }
}

int main(void)
{
%s
    send(&receiver.client);
    icd_client_tick(&receiver.client, 10 + receiver.client.settings.reply_timeout, on_event, NULL);
    send(&receiver.client);
    count = answer(line, sizeof line, 5);
    icd_client_received(&receiver.client, 2000, line, count, on_event, NULL);
    count = answer(line, sizeof line, 6);
    icd_client_received(&receiver.client, 2001, line, count, on_event, NULL);
    uint32_t deadline = 0;
    if (icd_client_deadline(&receiver.client, &deadline)) {
        return 1;
    }
    if (receiver_request_navigation_clock(&receiver, 9000) != ICD_OK ||
        receiver_request_navigation_clock(&receiver, 9000) != ICD_OK ||
        receiver_request_navigation_clock(&receiver, 9000) != ICD_ERROR_BUSY ||
        icd_client_request(&receiver.client, 9000, RECEIVER_END_OF_EPOCH_ID) != ICD_ERROR_UNSUPPORTED) {
        return 2;
    }
    send(&receiver.client);
    while (icd_client_deadline(&receiver.client, &deadline)) {
        icd_client_tick(&receiver.client, deadline, on_event, NULL);
        send(&receiver.client);
    }
    return 0;
}
"""
C_BEGIN = """
    const uint32_t now = 10;
    receiver_set_message_rate_t rate;
    size_t count = 0;
    receiver_set_message_rate_init(&rate);
"""
EXPECTED = [
    "sent 0122 8",
    "sent 0601 11",
    "sent 1537",
    "sent 0122 8",
    "done 290 5",
    "late 290 6",
]
# Two requests for the same telemetry: the second is sent when the first has ended.
EXPECTED += 2 * [*(4 * ["sent 0122 8"]), "timeout 290"]  # three retries

RUST = """
use icd::receiver::{self, NavigationClock, SetMessageRate};
use icd::wire::{stream, Client, Direction, Error, Event, NodeEvent};

type Line = stream::Line<{ receiver::LONGEST }, { receiver::SEQUENCES }>;

fn answer(bias: i32) -> Vec<u8> {
    let link = &receiver::LINK;
    let (mut clock, mut line) = (NavigationClock::default(), [0; 600]);
    clock.clock_bias = bias;
    let values = stream::Values::default();
    let data = icd::Message::to_bytes(&clock).unwrap();
    let size = stream::encode(link, Direction::Telemetry, 0x0122, data.as_ref(), &values, &mut line).unwrap();
    line[..size].to_vec()
}

fn report(event: NodeEvent<'_, receiver::Node>) {
    match (*event, event.message::<NavigationClock>()) {
        (Event::Timeout { id, .. }, _) => println!("timeout {id}"),
        (Event::Sent { id, .. }, _) => println!("sent {id}"),
        (Event::Done { id, .. }, Some(clock)) => println!("done {id} {}", clock.clock_bias),
        (Event::Late { id, .. }, Some(clock)) => println!("late {id} {}", clock.clock_bias),
        _ => println!("something else"),
    }
}

fn main() -> Result<(), Error> {
    let (now, mut line) = (10, [0; receiver::LONGEST]);
    %s
    macro_rules! output {
        () => {
            while let Some(bytes) = client.output(&mut line)? {
                println!("sent {:02x}{:02x} {}", bytes[2], bytes[3], bytes.len());
            }
        };
    }
    output!();
    client.tick(now + receiver::LINK.client.reply_timeout_ms, report);
    output!();
    client.received(2000, &answer(5), report);
    client.received(2001, &answer(6), report);
    assert_eq!(client.deadline(), None);
    client.request::<NavigationClock>(9000)?;
    client.request::<NavigationClock>(9000)?;
    assert_eq!(client.request::<NavigationClock>(9000), Err(Error::Busy));
    assert_eq!(client.request::<receiver::EndOfEpoch>(9000), Err(Error::Unsupported));
    output!();
    while let Some(deadline) = client.deadline() {
        client.tick(deadline, report);
        output!();
    }
    Ok(())
}
"""


def example_lines(language: str, first: str, last: str) -> str:
    """Return the lines of an example of the document, from ``first`` to ``last``."""
    block = re.search(rf"```{language}\n(.*?)```", SHOWN, re.S)
    assert block
    lines = block[1].splitlines()
    begin = next(number for number, line in enumerate(lines) if first in line)
    end = next(number for number, line in enumerate(lines) if last in line)
    return "\n".join(lines[begin : end + 1])


def test_c_client_completes_concurrent_requests(tmp_path):
    folder = c.generate(ICD, tmp_path)
    body = C_BEGIN + example_lines(
        "c", "receiver_client_t receiver", "receiver_send_set_message_rate"
    )
    (tmp_path / "ask.c").write_text(C % body)
    options = ("-std=c99", *c.WARNINGS, *c.SANITIZERS, f"-I{folder}")
    program = c.compile(tmp_path / "ask.c", *options, output=tmp_path / "ask")
    done = subprocess.run([program], capture_output=True, text=True)
    assert (done.returncode, done.stdout.splitlines()) == (0, EXPECTED), done.stderr


def test_rust_client_completes_concurrent_requests(tmp_path):
    tools, crate = Toolchain("default"), rust.generate(ICD, tmp_path)
    (tmp_path / "ask.rs").write_text(
        RUST % example_lines("rust", "let mut client", "client.send(")
    )
    program = tools.program(
        tmp_path / "ask.rs", tools.library(crate, *USED), tmp_path / "ask"
    )
    assert run(program).splitlines() == EXPECTED
