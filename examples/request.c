/* Asks a node on a TCP port, such as `icdgen sim --node cubeacp --tcp 4000`, for its attitude: request PORT */
#include <arpa/inet.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include "cubeacp.h"

static uint32_t milliseconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint32_t)now.tv_sec * 1000u + (uint32_t)(now.tv_nsec / 1000000);
}

static int port_to(const char *number)
{
    const struct timeval wait = {.tv_usec = 50000};
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_port = htons((uint16_t)atoi(number))};
    const int port = socket(AF_INET, SOCK_STREAM, 0);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    setsockopt(port, SOL_SOCKET, SO_RCVTIMEO, &wait, sizeof wait);
    return connect(port, (const struct sockaddr *)&address, sizeof address) == 0 ? port : -1;
}

static void on_event(void *context, const icd_event_t *event)
{
    cubeacp_estimated_attitude_angles_t angles;
    if (event->kind == ICD_EVENT_DONE &&
        cubeacp_estimated_attitude_angles_decode(&angles, event->data, event->length) == ICD_OK) {
        printf("roll %.2f deg\n", cubeacp_estimated_attitude_angles_estimated_roll_angle_deg(&angles));
        *(int *)context = 0;
    } else if (event->kind == ICD_EVENT_TIMEOUT) {
        fprintf(stderr, "no reply, asked %u times\n", (unsigned)event->attempts);
    }
}

int main(int argc, char **argv)
{
    static icd_client_t client;
    static uint8_t buffer[CUBEACP_CLIENT_BYTES], input[256];
    const int port = port_to(argc > 1 ? argv[1] : "4000");
    int status = 1;
    uint32_t deadline;

    icd_client_init(&client, cubeacp_link(), ICD_BUS_UART, buffer, sizeof buffer);
    ICD_REQUEST(&client, milliseconds(), CUBEACP_ESTIMATED_ATTITUDE_ANGLES);
    while (port >= 0 && icd_client_deadline(&client, &deadline)) {
        const uint8_t *bytes;
        size_t count;
        while (icd_client_output(&client, &bytes, &count)) {
            if (write(port, bytes, count) < 0) {
                return 1;
            }
        }
        const ssize_t got = read(port, input, sizeof input);
        icd_client_received(&client, milliseconds(), input, got > 0 ? (size_t)got : 0, on_event, &status);
    }
    return status;
}
