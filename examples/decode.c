/* Decodes a frame of telemetry 146, given as hex, with the header that icdgen makes. */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "cubeacp.h"

static size_t bytes_of(const char *hex, uint8_t *bytes, size_t capacity)
{
    size_t length = 0;
    unsigned value;
    while (length < capacity && strlen(hex) >= 2 && sscanf(hex, "%2x", &value) == 1) {
        bytes[length++] = (uint8_t)value;
        hex += 2;
    }
    return length;
}

int main(int argc, char **argv)
{
    uint8_t frame[64];
    const size_t length = bytes_of(argc > 1 ? argv[1] : "", frame, sizeof frame);

    cubeacp_estimated_attitude_angles_t angles;
    if (cubeacp_estimated_attitude_angles_decode(&angles, frame, length) != ICD_OK) {
        fprintf(stderr, "the frame has %zu bytes, not %u\n", length, CUBEACP_ESTIMATED_ATTITUDE_ANGLES_LENGTH);
        return 1;
    }
    printf("roll  %7" PRId16 "  %8.2f deg\n", angles.estimated_roll_angle,
           cubeacp_estimated_attitude_angles_estimated_roll_angle_deg(&angles));
    printf("pitch %7" PRId16 "  %8.2f deg\n", angles.estimated_pitch_angle,
           cubeacp_estimated_attitude_angles_estimated_pitch_angle_deg(&angles));
    printf("yaw   %7" PRId16 "  %8.2f deg\n", angles.estimated_yaw_angle,
           cubeacp_estimated_attitude_angles_estimated_yaw_angle_deg(&angles));
    return 0;
}
