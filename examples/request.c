/*
 * Asks a node on a TCP port, such as `icdgen sim --node cubeacp --tcp 4000`, for its attitude:
 * request [PORT]
 */
#include "cubeacp.h"
#include "port.h"

int main(int argc, char **argv)
{
    /* The client has a type of its own: the compiler rejects messages of other devices. */
    static cubeacp_client_t acp;
    static icd_slot_t slots[1]; /* one request at a time */
    static uint8_t buffer[CUBEACP_CLIENT_BYTES], frame[CUBEACP_LONGEST];
    cubeacp_estimated_attitude_angles_t angles;
    const int port = port_open("127.0.0.1", argc > 1 ? argv[1] : "4000");
    cubeacp_client_uart(&acp, slots, 1, buffer, sizeof buffer);
    cubeacp_request_estimated_attitude_angles(&acp, port_now());
    /* Sends, waits and repeats. */
    const icd_event_t end = port_ask(port, &acp.client, frame, sizeof frame);
    if (cubeacp_receive_estimated_attitude_angles(&angles, &end) != ICD_OK) {
        fprintf(stderr, "no telemetry, attempts: %u\n", (unsigned)end.attempts);
        return 1;
    }
    printf("roll %.2f deg\n", cubeacp_estimated_attitude_angles_estimated_roll_angle_deg(&angles));
    return 0;
}
