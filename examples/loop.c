/*
 * A main loop that never waits: it requests an angle once a second. Your UART driver provides the
 * three functions that are declared below. cc -std=c99 -Igenerated/c examples/loop.c driver.c
 */
#include <stdio.h>

#include "cubeacp.h"

/* Returns the time of a clock that never goes back. It may wrap. */
extern uint32_t milliseconds(void);
/* Copies the bytes that have been received. Returns 0 if there are none. */
extern size_t uart_read(uint8_t *bytes, size_t capacity);
/* Sends the bytes, or copies them to a queue. */
extern void uart_write(const uint8_t *bytes, size_t count);

static cubeacp_client_t acp;
static icd_slot_t slots[1]; /* one request at a time */
static uint8_t buffer[CUBEACP_CLIENT_BYTES]; /* memory of the client: a request and a response */

/* The client calls this function for each event. The event's data are valid during the call. */
static void show_event(void *context, const icd_event_t *event)
{
    cubeacp_estimated_attitude_angles_t angles;
    (void)context;
    if (cubeacp_receive_estimated_attitude_angles(&angles, event) == ICD_OK) {
        const double roll = cubeacp_estimated_attitude_angles_estimated_roll_angle_deg(&angles);
        printf("roll %.2f deg\n", roll);
    } else if (event->kind == ICD_EVENT_TIMEOUT) {
        printf("no response to %u requests\n", (unsigned)event->attempts);
    }
}

int main(void)
{
    uint32_t next = milliseconds(); /* time of the next request */
    if (cubeacp_client_uart(&acp, slots, 1, buffer, sizeof buffer) != ICD_OK) {
        return 1;
    }
    for (;;) {
        const uint32_t now = milliseconds();
        uint8_t bytes[64];
        uint8_t input[64];
        size_t count;
        const bool is_due = (int32_t)(now - next) >= 0;
        if (is_due && cubeacp_request_estimated_attitude_angles(&acp, now) == ICD_OK) {
            next = now + 1000u;
        }
        while (icd_client_output(&acp.client, bytes, sizeof bytes, &count)) {
            uart_write(bytes, count);
        }
        count = uart_read(input, sizeof input);
        /* Also without input: the client checks its time-outs. */
        icd_client_received(&acp.client, now, input, count, show_event, NULL);
    }
}
