/*
 * Decodes a telemetry frame of the CubeACP:
 *
 *   $ decode 146 2efb0a000000
 *   Estimated Attitude Angles: roll -12.34, pitch 0.1, yaw 0 deg
 */
#include "cubeacp.h"

#include <stdio.h>
#include <stdlib.h>

static size_t parse(const char *hex, uint8_t *bytes, size_t capacity)
{
    size_t length = 0;
    unsigned value;
    while (length < capacity && sscanf(hex, "%2x", &value) == 1 && hex[1] != '\0') {
        bytes[length++] = (uint8_t)value;
        hex += 2;
    }
    return length;
}

int main(int count, char **arguments)
{
    if (count != 3) {
        fprintf(stderr, "usage: %s ID HEX\n", arguments[0]);
        return 2;
    }
    const unsigned long number = strtoul(arguments[1], NULL, 10);
    const uint8_t id = (uint8_t)number;
    uint8_t frame[1024];
    const size_t length = parse(arguments[2], frame, sizeof frame);

    cubeacp_telemetry_t telemetry;
    const icd_status_t status =
        number == id ? cubeacp_telemetry_decode(&telemetry, id, frame, length) : ICD_ERROR_UNKNOWN_ID;
    if (status == ICD_ERROR_UNKNOWN_ID) {
        fprintf(stderr, "no telemetry %lu\n", number);
        return 1;
    }
    if (status == ICD_ERROR_LENGTH) {
        size_t expected = 0;
        (void)cubeacp_telemetry_length(id, &expected);
        fprintf(stderr, "%s has %zu bytes, %zu given\n", cubeacp_telemetry_name(id), expected, length);
        return 1;
    }

    printf("%s", cubeacp_telemetry_name(id));
    switch (telemetry.id) {
    case CUBEACP_ESTIMATED_ATTITUDE_ANGLES_ID: {
        const cubeacp_estimated_attitude_angles_t *const angles = &telemetry.as.estimated_attitude_angles;
        printf(
            ": roll %g, pitch %g, yaw %g deg", cubeacp_estimated_attitude_angles_estimated_roll_angle_deg(angles),
            cubeacp_estimated_attitude_angles_estimated_pitch_angle_deg(angles),
            cubeacp_estimated_attitude_angles_estimated_yaw_angle_deg(angles));
        break;
    }
    case CUBEACP_CURRENT_ADCS_STATE_ID: {
        const cubeacp_current_adcs_state_t *const state = &telemetry.as.current_adcs_state;
        const char *const mode = cubeacp_con_mode_select_name(state->control_mode);
        printf(": control mode %s", mode != NULL ? mode : "unknown");
        break;
    }
    default:
        break;
    }
    printf("\n");
    return 0;
}
