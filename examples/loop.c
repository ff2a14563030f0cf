/*
 * A main loop that never waits: it requests an angle once a second. Your UART driver provides the three functions that
 * are declared below. cc -std=c99 -Igenerated/c examples/loop.c driver.c
 */
#include <stdio.h>

#include "cubeacp.h"

extern uint32_t milliseconds(void);                         /* of a clock that never goes back; may wrap */
extern size_t uart_read(uint8_t *bytes, size_t capacity);   /* copies what has been received; returns 0 if nothing */
extern void uart_write(const uint8_t *bytes, size_t count); /* sends the bytes, or copies them to a queue */

static cubeacp_client_t acp;
static uint8_t buffer[CUBEACP_CLIENT_BYTES]; /* memory of the client: a request and a response */

/* The client calls this function for each event. The data of the event are valid during the call. */
static void show_event(void *context, const icd_event_t *event)
{
    cubeacp_estimated_attitude_angles_t angles;
    (void)context;
    if (cubeacp_receive_estimated_attitude_angles(&angles, event) == ICD_OK) {
        printf("roll %.2f deg\n", cubeacp_estimated_attitude_angles_estimated_roll_angle_deg(&angles));
    } else if (event->kind == ICD_EVENT_TIMEOUT) {
        printf("no response to %u requests\n", (unsigned)event->attempts);
    }
}

int main(void)
{
    uint32_t next = milliseconds(); /* time of the next request */
    if (cubeacp_client_uart(&acp, buffer, sizeof buffer) != ICD_OK) {
        return 1;
    }
    for (;;) {
        const uint32_t now = milliseconds();
        const uint8_t *bytes;
        uint8_t input[64];
        size_t count;
        if ((int32_t)(now - next) >= 0 && cubeacp_request_estimated_attitude_angles(&acp, now) == ICD_OK) {
            next = now + 1000u;
        }
        while (icd_client_output(&acp.client, &bytes, &count)) {
            uart_write(bytes, count);
        }
        count = uart_read(input, sizeof input);
        icd_client_received(&acp.client, now, input, count, show_event, NULL); /* also if nothing came: time-outs */
    }
}
