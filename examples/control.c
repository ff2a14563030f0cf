/*
 * Sends two telecommands, reads two messages, and prints errors. In another terminal:
 * icdgen sim --node cubeacp --tcp 4000
 *
 * cc -std=c99 -D_POSIX_C_SOURCE=200809L -Igenerated/c examples/control.c -o control
 * ./control 4000
 */
#include "cubeacp.h"
#include "port.h"

static cubeacp_client_t acp;
static icd_slot_t slots[1]; /* one request at a time */
static uint8_t buffer[CUBEACP_CLIENT_BYTES], frame[CUBEACP_LONGEST];

/*
 * Waits for the outcome of a request that was started with the status `started`. Exits unless the
 * request succeeds.
 */
static icd_event_t done(int port, icd_status_t started)
{
    icd_event_t end;
    /* ICD_ERROR_RANGE: a value does not fit its field. ICD_ERROR_BUSY: a request is pending. */
    if (started != ICD_OK) {
        fprintf(stderr, "not sent, status %d\n", (int)started);
        exit(EXIT_FAILURE);
    }
    /* Sends, waits, and repeats requests of telemetry. */
    end = port_ask(port, &acp.client, frame, sizeof frame);
    /* cubeacp_refusal(&end, &reason) gets the code as a value of its enumeration. */
    if (end.kind == ICD_EVENT_REFUSED) {
        fprintf(stderr, "refused, code %u\n", (unsigned)end.code);
        exit(EXIT_FAILURE);
    }
    if (end.kind != ICD_EVENT_DONE) {
        fprintf(stderr, "no response, attempts: %u\n", (unsigned)end.attempts);
        exit(EXIT_FAILURE);
    }
    return end;
}

int main(int argc, char **argv)
{
    cubeacp_set_wheel_speed_t speed;
    cubeacp_commanded_attitude_angles_t commanded;
    cubeacp_estimated_attitude_angles_t angles;
    cubeacp_current_adcs_state_t state;
    icd_event_t end;
    const int port = port_open("127.0.0.1", argc > 1 ? argv[1] : "4000");
    if (cubeacp_client_uart(&acp, slots, 1, buffer, sizeof buffer) != ICD_OK) {
        return 1;
    }

    cubeacp_set_wheel_speed_init(&speed);
    speed.commanded_x_speed = 100; /* a field without a formula: its raw value is in rpm */
    done(port, cubeacp_send_set_wheel_speed(&acp, port_now(), &speed));

    cubeacp_commanded_attitude_angles_init(&commanded);
    if (cubeacp_commanded_attitude_angles_set_commanded_roll_angle_deg(&commanded, 1.5) != ICD_OK) {
        return 1; /* 1.5 deg does not fit the field */
    }
    done(port, cubeacp_send_commanded_attitude_angles(&acp, port_now(), &commanded));

    end = done(port, cubeacp_request_estimated_attitude_angles(&acp, port_now()));
    if (cubeacp_receive_estimated_attitude_angles(&angles, &end) == ICD_OK) {
        const double roll = cubeacp_estimated_attitude_angles_estimated_roll_angle_deg(&angles);
        printf("roll %.2f deg\n", roll);
    }

    end = done(port, cubeacp_request_current_adcs_state(&acp, port_now()));
    if (cubeacp_receive_current_adcs_state(&state, &end) == ICD_OK) {
        /* The mode can be a value that the ICD does not name. Its name is NULL then. */
        const cubeacp_estim_mode_select_t mode = state.attitude_estimation_mode;
        const char *const name = cubeacp_estim_mode_select_name(mode);
        if (mode == CUBEACP_ESTIM_MODE_SELECT_NO_ATTITUDE_ESTIMATION) {
            printf("nothing is estimated\n");
        } else if (name != NULL) {
            printf("estimated by %s\n", name);
        } else {
            printf("estimation mode %u has no name\n", (unsigned)mode);
        }
    }
    return 0;
}
