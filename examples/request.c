/* Asks a node on a TCP port, such as `icdgen sim --node cubeacp --tcp 4000`, for its attitude: request [PORT] */
#include "cubeacp.h"
#include "port.h"

int main(int argc, char **argv)
{
    static icd_client_t client;
    static uint8_t buffer[CUBEACP_CLIENT_BYTES], frame[CUBEACP_LONGEST];
    cubeacp_estimated_attitude_angles_t angles;
    const int port = port_open("127.0.0.1", argc > 1 ? argv[1] : "4000");
    icd_client_init(&client, cubeacp_link(), ICD_BUS_UART, buffer, sizeof buffer);
    if (ICD_REQUEST(&client, port_now(), CUBEACP_ESTIMATED_ATTITUDE_ANGLES) != ICD_OK) {
        return fprintf(stderr, "no such request on this bus\n"), 1;
    }
    const icd_event_t end = port_ask(port, &client, frame, sizeof frame); /* sends, waits, asks again */
    if (cubeacp_estimated_attitude_angles_decode(&angles, frame, end.length) != ICD_OK) {
        return fprintf(stderr, "no reply, asked %u times\n", (unsigned)end.attempts), 1;
    }
    printf("roll %.2f deg\n", cubeacp_estimated_attitude_angles_estimated_roll_angle_deg(&angles));
    return 0;
}
