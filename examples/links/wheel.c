/*
 * Commands the reaction wheel of wheel.yaml, which acknowledges or refuses each telecommand. In
 * another terminal: icdgen sim --icd examples/links/wheel.yaml --tcp 4000
 *
 * icdgen --lang c --out build/wheel examples/links/wheel.yaml
 * cc -std=c99 -D_POSIX_C_SOURCE=200809L -Ibuild/wheel -Iexamples examples/links/wheel.c -o wheel
 * ./wheel 4000
 */
#include "port.h"
#include "wheel.h"

static wheel_client_t wheel;
static icd_slot_t slots[1]; /* one request at a time */
static uint8_t buffer[WHEEL_CLIENT_BYTES];

/* The client calls this function for each event. The event's data are valid during the call. */
static void on_event(void *context, const icd_event_t *event)
{
    wheel_nak_reason_t reason;
    wheel_events_t events;
    (void)context;
    switch (event->kind) {
    case ICD_EVENT_DONE: /* acknowledged, or the requested telemetry */
        if (wheel_receive_events(&events, event) == ICD_OK) {
            printf("%u events\n", (unsigned)events.count);
        }
        break;
    case ICD_EVENT_REFUSED:
        if (wheel_refusal(event, &reason)) {
            fprintf(stderr, "refused: %s\n", wheel_nak_reason_name(reason));
        }
        exit(EXIT_FAILURE);
    case ICD_EVENT_BUSY: /* also at the last attempt */
        fprintf(stderr, "busy, attempts: %u\n", (unsigned)event->attempts);
        exit(EXIT_FAILURE);
    case ICD_EVENT_TIMEOUT: /* it is not known whether the telecommand was executed */
        fprintf(stderr, "no response, attempts: %u\n", (unsigned)event->attempts);
        exit(EXIT_FAILURE);
    default: /* progress, unsolicited and late telemetry, errors of the line */
        break;
    }
}

/* Passes bytes between the client and the port until the request that was started has ended. */
static void wait(int port, icd_status_t started)
{
    uint8_t line[WHEEL_LINE_BYTES], input[64];
    uint32_t deadline;
    size_t count;
    if (started != ICD_OK) { /* ICD_ERROR_RANGE: a value does not fit its field */
        fprintf(stderr, "not sent, status %d\n", (int)started);
        exit(EXIT_FAILURE);
    }
    for (;;) {
        while (icd_client_output(&wheel.client, line, sizeof line, &count)) {
            port_write(port, line, count);
        }
        if (!icd_client_deadline(&wheel.client, &deadline)) {
            return; /* no request is in progress */
        }
        count = port_read(port, input, sizeof input, deadline);
        icd_client_received(&wheel.client, port_now(), input, count, on_event, NULL);
    }
}

int main(int argc, char **argv)
{
    const int port = port_open("127.0.0.1", argc > 1 ? argv[1] : "4000");
    wheel_set_mode_t mode = {WHEEL_MODE_SPEED};
    wheel_set_speed_t speed;
    memset(&speed, 0, sizeof speed);
    if (wheel_client_init(&wheel, slots, 1, buffer, sizeof buffer) != ICD_OK) {
        return EXIT_FAILURE;
    }
    wait(port, wheel_send_set_mode(&wheel, port_now(), &mode));
    if (wheel_set_speed_set_speed_rpm(&speed, 1500.0) == ICD_OK) {
        wait(port, wheel_send_set_speed(&wheel, port_now(), &speed));
    }
    wait(port, wheel_request_events(&wheel, port_now()));
    return EXIT_SUCCESS;
}
