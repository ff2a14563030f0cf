/*
 * The five frames of the bench as an expert writes them: one shift and mask a field, restrict, whole words by memcpy on a
 * little-endian machine, no length check, no range check. They fill the generated structs, so that only the code differs.
 */
#include "cubeacp.h"

void hand_decode_132(cubeacp_current_adcs_state_t *restrict m, const uint8_t *restrict b);
void hand_decode_132(cubeacp_current_adcs_state_t *restrict m, const uint8_t *restrict b)
{
    m->attitude_estimation_mode = b[0] & 0x0F;
    m->control_mode = b[0] >> 4;
    m->adcs_run_mode = b[1] & 0x03;
    m->asgp4_mode = (b[1] >> 2) & 0x03;
    m->cubecontrol_signal_enabled = (b[1] & 0x10) != 0;
    m->cubecontrol_motor_enabled = (b[1] & 0x20) != 0;
    m->cubesense1_enabled = (b[1] & 0x40) != 0;
    m->cubesense2_enabled = (b[1] & 0x80) != 0;
    m->cubewheel1_enabled = (b[2] & 0x01) != 0;
    m->cubewheel2_enabled = (b[2] & 0x02) != 0;
    m->cubewheel3_enabled = (b[2] & 0x04) != 0;
    m->cubestar_enabled = (b[2] & 0x08) != 0;
    m->gps_receiver_enabled = (b[2] & 0x10) != 0;
    m->gps_lna_power_enabled = (b[2] & 0x20) != 0;
    m->motor_driver_enabled = (b[2] & 0x40) != 0;
    m->sun_is_above_local_horizon = (b[2] & 0x80) != 0;
    m->cubesense1_communications_error = (b[3] & 0x01) != 0;
    m->cubesense2_communications_error = (b[3] & 0x02) != 0;
    m->cubecontrol_signal_communications_error = (b[3] & 0x04) != 0;
    m->cubecontrol_motor_communications_error = (b[3] & 0x08) != 0;
    m->cubewheel1_communications_error = (b[3] & 0x10) != 0;
    m->cubewheel2_communications_error = (b[3] & 0x20) != 0;
    m->cubewheel3_communications_error = (b[3] & 0x40) != 0;
    m->cubestar_communications_error = (b[3] & 0x80) != 0;
    m->magnetometer_range_error = (b[4] & 0x01) != 0;
    m->cam1_sram_overcurrent_detected = (b[4] & 0x02) != 0;
    m->cam1_3v3_overcurrent_detected = (b[4] & 0x04) != 0;
    m->cam1_sensor_busy_error = (b[4] & 0x08) != 0;
    m->cam1_sensor_detection_error = (b[4] & 0x10) != 0;
    m->sun_sensor_range_error = (b[4] & 0x20) != 0;
    m->cam2_sram_overcurrent_detected = (b[4] & 0x40) != 0;
    m->cam2_3v3_overcurrent_detected = (b[4] & 0x80) != 0;
    m->cam2_sensor_busy_error = (b[5] & 0x01) != 0;
    m->cam2_sensor_detection_error = (b[5] & 0x02) != 0;
    m->nadir_sensor_range_error = (b[5] & 0x04) != 0;
    m->rate_sensor_range_error = (b[5] & 0x08) != 0;
    m->wheel_speed_range_error = (b[5] & 0x10) != 0;
    m->coarse_sun_sensor_error = (b[5] & 0x20) != 0;
    m->star_tracker_match_error = (b[5] & 0x40) != 0;
    m->star_tracker_overcurrent_detected = (b[5] & 0x80) != 0;
}

void hand_encode_132(const cubeacp_current_adcs_state_t *restrict m, uint8_t *restrict b);
void hand_encode_132(const cubeacp_current_adcs_state_t *restrict m, uint8_t *restrict b)
{
    b[0] = (uint8_t)(m->attitude_estimation_mode | m->control_mode << 4);
    b[1] = (uint8_t)(m->adcs_run_mode | m->asgp4_mode << 2 | m->cubecontrol_signal_enabled << 4 |
                     m->cubecontrol_motor_enabled << 5 | m->cubesense1_enabled << 6 | m->cubesense2_enabled << 7);
    b[2] = (uint8_t)(m->cubewheel1_enabled | m->cubewheel2_enabled << 1 | m->cubewheel3_enabled << 2 |
                     m->cubestar_enabled << 3 | m->gps_receiver_enabled << 4 | m->gps_lna_power_enabled << 5 |
                     m->motor_driver_enabled << 6 | m->sun_is_above_local_horizon << 7);
    b[3] = (uint8_t)(m->cubesense1_communications_error | m->cubesense2_communications_error << 1 |
                     m->cubecontrol_signal_communications_error << 2 | m->cubecontrol_motor_communications_error << 3 |
                     m->cubewheel1_communications_error << 4 | m->cubewheel2_communications_error << 5 |
                     m->cubewheel3_communications_error << 6 | m->cubestar_communications_error << 7);
    b[4] = (uint8_t)(m->magnetometer_range_error | m->cam1_sram_overcurrent_detected << 1 |
                     m->cam1_3v3_overcurrent_detected << 2 | m->cam1_sensor_busy_error << 3 |
                     m->cam1_sensor_detection_error << 4 | m->sun_sensor_range_error << 5 |
                     m->cam2_sram_overcurrent_detected << 6 | m->cam2_3v3_overcurrent_detected << 7);
    b[5] =
        (uint8_t)(m->cam2_sensor_busy_error | m->cam2_sensor_detection_error << 1 | m->nadir_sensor_range_error << 2 |
                  m->rate_sensor_range_error << 3 | m->wheel_speed_range_error << 4 | m->coarse_sun_sensor_error << 5 |
                  m->star_tracker_match_error << 6 | m->star_tracker_overcurrent_detected << 7);
}

void hand_decode_190(cubeacp_adcs_state_t *restrict m, const uint8_t *restrict b);
void hand_decode_190(cubeacp_adcs_state_t *restrict m, const uint8_t *restrict b)
{
    m->attitude_estimation_mode = b[0] & 0x0F;
    m->control_mode = b[0] >> 4;
    m->adcs_run_mode = b[1] & 0x03;
    m->asgp4_mode = (b[1] >> 2) & 0x03;
    m->cubecontrol_signal_enabled = (b[1] & 0x10) != 0;
    m->cubecontrol_motor_enabled = (b[1] & 0x20) != 0;
    m->cubesense1_enabled = (b[1] & 0x40) != 0;
    m->cubesense2_enabled = (b[1] & 0x80) != 0;
    m->cubewheel1_enabled = (b[2] & 0x01) != 0;
    m->cubewheel2_enabled = (b[2] & 0x02) != 0;
    m->cubewheel3_enabled = (b[2] & 0x04) != 0;
    m->cubestar_enabled = (b[2] & 0x08) != 0;
    m->gps_receiver_enabled = (b[2] & 0x10) != 0;
    m->gps_lna_power_enabled = (b[2] & 0x20) != 0;
    m->motor_driver_enabled = (b[2] & 0x40) != 0;
    m->sun_is_above_local_horizon = (b[2] & 0x80) != 0;
    m->cubesense1_communications_error = (b[3] & 0x01) != 0;
    m->cubesense2_communications_error = (b[3] & 0x02) != 0;
    m->cubecontrol_signal_communications_error = (b[3] & 0x04) != 0;
    m->cubecontrol_motor_communications_error = (b[3] & 0x08) != 0;
    m->cubewheel1_communications_error = (b[3] & 0x10) != 0;
    m->cubewheel2_communications_error = (b[3] & 0x20) != 0;
    m->cubewheel3_communications_error = (b[3] & 0x40) != 0;
    m->cubestar_communications_error = (b[3] & 0x80) != 0;
    m->magnetometer_range_error = (b[4] & 0x01) != 0;
    m->cam1_sram_overcurrent_detected = (b[4] & 0x02) != 0;
    m->cam1_3v3_overcurrent_detected = (b[4] & 0x04) != 0;
    m->cam1_sensor_busy_error = (b[4] & 0x08) != 0;
    m->cam1_sensor_detection_error = (b[4] & 0x10) != 0;
    m->sun_sensor_range_error = (b[4] & 0x20) != 0;
    m->cam2_sram_overcurrent_detected = (b[4] & 0x40) != 0;
    m->cam2_3v3_overcurrent_detected = (b[4] & 0x80) != 0;
    m->cam2_sensor_busy_error = (b[5] & 0x01) != 0;
    m->cam2_sensor_detection_error = (b[5] & 0x02) != 0;
    m->nadir_sensor_range_error = (b[5] & 0x04) != 0;
    m->rate_sensor_range_error = (b[5] & 0x08) != 0;
    m->wheel_speed_range_error = (b[5] & 0x10) != 0;
    m->coarse_sun_sensor_error = (b[5] & 0x20) != 0;
    m->star_tracker_match_error = (b[5] & 0x40) != 0;
    m->star_tracker_overcurrent_detected = (b[5] & 0x80) != 0;
    m->orbit_parameters_are_invalid = (b[6] & 0x01) != 0;
    m->configuration_is_invalid = (b[6] & 0x02) != 0;
    m->control_mode_change_is_not_allowed = (b[6] & 0x04) != 0;
    m->estimator_change_is_not_allowed = (b[6] & 0x08) != 0;
    m->current_magnetometer_sampling_mode = (b[6] >> 4) & 0x03;
    m->magnetic_field_size_mismatch = (b[6] & 0x40) != 0;
    m->node_recovery_error = (b[6] & 0x80) != 0;
    m->cubesense1_runtime_error = (b[7] & 0x01) != 0;
    m->cubesense2_runtime_error = (b[7] & 0x02) != 0;
    m->cubecontrol_signal_runtime_error = (b[7] & 0x04) != 0;
    m->cubecontrol_motor_runtime_error = (b[7] & 0x08) != 0;
    m->cubewheel1_runtime_error = (b[7] & 0x10) != 0;
    m->cubewheel2_runtime_error = (b[7] & 0x20) != 0;
    m->cubewheel3_runtime_error = (b[7] & 0x40) != 0;
    m->cubestar_runtime_error = (b[7] & 0x80) != 0;
    m->magnetometer_error = (b[8] & 0x01) != 0;
    m->rate_sensor_failure = (b[8] & 0x02) != 0;
    memcpy(&m->estimated_roll_angle, b + 12, 2);
    memcpy(&m->estimated_pitch_angle, b + 14, 2);
    memcpy(&m->estimated_yaw_angle, b + 16, 2);
    memcpy(&m->estimated_q1, b + 18, 2);
    memcpy(&m->estimated_q2, b + 20, 2);
    memcpy(&m->estimated_q3, b + 22, 2);
    memcpy(&m->estimated_x_angular_rate, b + 24, 2);
    memcpy(&m->estimated_y_angular_rate, b + 26, 2);
    memcpy(&m->estimated_z_angular_rate, b + 28, 2);
    memcpy(&m->x_position, b + 30, 2);
    memcpy(&m->y_position, b + 32, 2);
    memcpy(&m->z_position, b + 34, 2);
    memcpy(&m->x_velocity, b + 36, 2);
    memcpy(&m->y_velocity, b + 38, 2);
    memcpy(&m->z_velocity, b + 40, 2);
    memcpy(&m->latitude, b + 42, 2);
    memcpy(&m->longitude, b + 44, 2);
    memcpy(&m->altitude, b + 46, 2);
    memcpy(&m->ecef_position_x, b + 48, 2);
    memcpy(&m->ecef_position_y, b + 50, 2);
    memcpy(&m->ecef_position_z, b + 52, 2);
}

void hand_encode_190(const cubeacp_adcs_state_t *restrict m, uint8_t *restrict b);
void hand_encode_190(const cubeacp_adcs_state_t *restrict m, uint8_t *restrict b)
{
    b[0] = (uint8_t)(m->attitude_estimation_mode | m->control_mode << 4);
    b[1] = (uint8_t)(m->adcs_run_mode | m->asgp4_mode << 2 | m->cubecontrol_signal_enabled << 4 |
                     m->cubecontrol_motor_enabled << 5 | m->cubesense1_enabled << 6 | m->cubesense2_enabled << 7);
    b[2] = (uint8_t)(m->cubewheel1_enabled | m->cubewheel2_enabled << 1 | m->cubewheel3_enabled << 2 |
                     m->cubestar_enabled << 3 | m->gps_receiver_enabled << 4 | m->gps_lna_power_enabled << 5 |
                     m->motor_driver_enabled << 6 | m->sun_is_above_local_horizon << 7);
    b[3] = (uint8_t)(m->cubesense1_communications_error | m->cubesense2_communications_error << 1 |
                     m->cubecontrol_signal_communications_error << 2 | m->cubecontrol_motor_communications_error << 3 |
                     m->cubewheel1_communications_error << 4 | m->cubewheel2_communications_error << 5 |
                     m->cubewheel3_communications_error << 6 | m->cubestar_communications_error << 7);
    b[4] = (uint8_t)(m->magnetometer_range_error | m->cam1_sram_overcurrent_detected << 1 |
                     m->cam1_3v3_overcurrent_detected << 2 | m->cam1_sensor_busy_error << 3 |
                     m->cam1_sensor_detection_error << 4 | m->sun_sensor_range_error << 5 |
                     m->cam2_sram_overcurrent_detected << 6 | m->cam2_3v3_overcurrent_detected << 7);
    b[5] =
        (uint8_t)(m->cam2_sensor_busy_error | m->cam2_sensor_detection_error << 1 | m->nadir_sensor_range_error << 2 |
                  m->rate_sensor_range_error << 3 | m->wheel_speed_range_error << 4 | m->coarse_sun_sensor_error << 5 |
                  m->star_tracker_match_error << 6 | m->star_tracker_overcurrent_detected << 7);
    b[6] = (uint8_t)(m->orbit_parameters_are_invalid | m->configuration_is_invalid << 1 |
                     m->control_mode_change_is_not_allowed << 2 | m->estimator_change_is_not_allowed << 3 |
                     m->current_magnetometer_sampling_mode << 4 | m->magnetic_field_size_mismatch << 6 |
                     m->node_recovery_error << 7);
    b[7] = (uint8_t)(m->cubesense1_runtime_error | m->cubesense2_runtime_error << 1 |
                     m->cubecontrol_signal_runtime_error << 2 | m->cubecontrol_motor_runtime_error << 3 |
                     m->cubewheel1_runtime_error << 4 | m->cubewheel2_runtime_error << 5 |
                     m->cubewheel3_runtime_error << 6 | m->cubestar_runtime_error << 7);
    b[8] = (uint8_t)(m->magnetometer_error | m->rate_sensor_failure << 1);
    b[9] = 0;
    b[10] = 0;
    b[11] = 0;
    memcpy(b + 12, &m->estimated_roll_angle, 2);
    memcpy(b + 14, &m->estimated_pitch_angle, 2);
    memcpy(b + 16, &m->estimated_yaw_angle, 2);
    memcpy(b + 18, &m->estimated_q1, 2);
    memcpy(b + 20, &m->estimated_q2, 2);
    memcpy(b + 22, &m->estimated_q3, 2);
    memcpy(b + 24, &m->estimated_x_angular_rate, 2);
    memcpy(b + 26, &m->estimated_y_angular_rate, 2);
    memcpy(b + 28, &m->estimated_z_angular_rate, 2);
    memcpy(b + 30, &m->x_position, 2);
    memcpy(b + 32, &m->y_position, 2);
    memcpy(b + 34, &m->z_position, 2);
    memcpy(b + 36, &m->x_velocity, 2);
    memcpy(b + 38, &m->y_velocity, 2);
    memcpy(b + 40, &m->z_velocity, 2);
    memcpy(b + 42, &m->latitude, 2);
    memcpy(b + 44, &m->longitude, 2);
    memcpy(b + 46, &m->altitude, 2);
    memcpy(b + 48, &m->ecef_position_x, 2);
    memcpy(b + 50, &m->ecef_position_y, 2);
    memcpy(b + 52, &m->ecef_position_z, 2);
}

void hand_decode_206(cubeacp_adcs_configuration_t *restrict m, const uint8_t *restrict b);
void hand_decode_206(cubeacp_adcs_configuration_t *restrict m, const uint8_t *restrict b)
{
    m->magnetorquer_1_configuration = b[0];
    m->magnetorquer_2_configuration = b[1];
    m->magnetorquer_3_configuration = b[2];
    m->rw1_configuration = b[3];
    m->rw2_configuration = b[4];
    m->rw3_configuration = b[5];
    m->rw4_configuration = b[6];
    m->gyro1_configuration = b[7];
    m->gyro2_configuration = b[8];
    m->gyro3_configuration = b[9];
    memcpy(&m->x_rate_sensor_offset, b + 10, 2);
    memcpy(&m->y_rate_sensor_offset, b + 12, 2);
    memcpy(&m->z_rate_sensor_offset, b + 14, 2);
    m->rate_sensor_mult = b[16];
    m->css1_configuration = b[17];
    m->css2_configuration = b[18];
    m->css3_configuration = b[19];
    m->css4_configuration = b[20];
    m->css5_configuration = b[21];
    m->css6_configuration = b[22];
    m->css7_configuration = b[23];
    m->css8_configuration = b[24];
    m->css9_configuration = b[25];
    m->css10_configuration = b[26];
    m->css1_relative_scale = b[27];
    m->css2_relative_scale = b[28];
    m->css3_relative_scale = b[29];
    m->css4_relative_scale = b[30];
    m->css5_relative_scale = b[31];
    m->css6_relative_scale = b[32];
    m->css7_relative_scale = b[33];
    m->css8_relative_scale = b[34];
    m->css9_relative_scale = b[35];
    m->css10_relative_scale = b[36];
    m->css_threshold = b[37];
    memcpy(&m->cam1_mounting_alpha, b + 38, 2);
    memcpy(&m->cam1_mounting_beta, b + 40, 2);
    memcpy(&m->cam1_mounting_gamma, b + 42, 2);
    m->cam1_detection_threshold = b[44];
    m->cam1_sensor_auto_adjust_mode = (b[45] & 0x01) != 0;
    memcpy(&m->cam1_sensor_exposure_time, b + 46, 2);
    memcpy(&m->cam1_boresight_x, b + 48, 2);
    memcpy(&m->cam1_boresight_y, b + 50, 2);
    memcpy(&m->cam2_mounting_alpha, b + 52, 2);
    memcpy(&m->cam2_mounting_beta, b + 54, 2);
    memcpy(&m->cam2_mounting_gamma, b + 56, 2);
    m->cam2_detection_threshold = b[58];
    m->cam2_sensor_auto_adjust_mode = (b[59] & 0x01) != 0;
    memcpy(&m->cam2_sensor_exposure_time, b + 60, 2);
    memcpy(&m->cam2_boresight_x, b + 62, 2);
    memcpy(&m->cam2_boresight_y, b + 64, 2);
    m->nadir_max_deviation_percentage = b[66];
    m->nadir_max_bad_edges = b[67];
    m->nadir_max_radius = b[68];
    m->nadir_min_radius = b[69];
    memcpy(&m->cam_1_minimum_x_of_area_1, b + 70, 2);
    memcpy(&m->cam_1_maximum_x_of_area_1, b + 72, 2);
    memcpy(&m->cam_1_minimum_y_of_area_1, b + 74, 2);
    memcpy(&m->cam_1_maximum_y_of_area_1, b + 76, 2);
    memcpy(&m->cam_1_minimum_x_of_area_2, b + 78, 2);
    memcpy(&m->cam_1_maximum_x_of_area_2, b + 80, 2);
    memcpy(&m->cam_1_minimum_y_of_area_2, b + 82, 2);
    memcpy(&m->cam_1_maximum_y_of_area_2, b + 84, 2);
    memcpy(&m->cam_1_minimum_x_of_area_3, b + 86, 2);
    memcpy(&m->cam_1_maximum_x_of_area_3, b + 88, 2);
    memcpy(&m->cam_1_minimum_y_of_area_3, b + 90, 2);
    memcpy(&m->cam_1_maximum_y_of_area_3, b + 92, 2);
    memcpy(&m->cam_1_minimum_x_of_area_4, b + 94, 2);
    memcpy(&m->cam_1_maximum_x_of_area_4, b + 96, 2);
    memcpy(&m->cam_1_minimum_y_of_area_4, b + 98, 2);
    memcpy(&m->cam_1_maximum_y_of_area_4, b + 100, 2);
    memcpy(&m->cam_1_minimum_x_of_area_5, b + 102, 2);
    memcpy(&m->cam_1_maximum_x_of_area_5, b + 104, 2);
    memcpy(&m->cam_1_minimum_y_of_area_5, b + 106, 2);
    memcpy(&m->cam_1_maximum_y_of_area_5, b + 108, 2);
    memcpy(&m->cam_2_minimum_x_of_area_1, b + 110, 2);
    memcpy(&m->cam_2_maximum_x_of_area_1, b + 112, 2);
    memcpy(&m->cam_2_minimum_y_of_area_1, b + 114, 2);
    memcpy(&m->cam_2_maximum_y_of_area_1, b + 116, 2);
    memcpy(&m->cam_2_minimum_x_of_area_2, b + 118, 2);
    memcpy(&m->cam_2_maximum_x_of_area_2, b + 120, 2);
    memcpy(&m->cam_2_minimum_y_of_area_2, b + 122, 2);
    memcpy(&m->cam_2_maximum_y_of_area_2, b + 124, 2);
    memcpy(&m->cam_2_minimum_x_of_area_3, b + 126, 2);
    memcpy(&m->cam_2_maximum_x_of_area_3, b + 128, 2);
    memcpy(&m->cam_2_minimum_y_of_area_3, b + 130, 2);
    memcpy(&m->cam_2_maximum_y_of_area_3, b + 132, 2);
    memcpy(&m->cam_2_minimum_x_of_area_4, b + 134, 2);
    memcpy(&m->cam_2_maximum_x_of_area_4, b + 136, 2);
    memcpy(&m->cam_2_minimum_y_of_area_4, b + 138, 2);
    memcpy(&m->cam_2_maximum_y_of_area_4, b + 140, 2);
    memcpy(&m->cam_2_minimum_x_of_area_5, b + 142, 2);
    memcpy(&m->cam_2_maximum_x_of_area_5, b + 144, 2);
    memcpy(&m->cam_2_minimum_y_of_area_5, b + 146, 2);
    memcpy(&m->cam_2_maximum_y_of_area_5, b + 148, 2);
    memcpy(&m->magnetometer_mounting_alpha, b + 150, 2);
    memcpy(&m->magnetometer_mounting_beta, b + 152, 2);
    memcpy(&m->magnetometer_mounting_gamma, b + 154, 2);
    memcpy(&m->magnetometer_channel_1_offset, b + 156, 2);
    memcpy(&m->magnetometer_channel_2_offset, b + 158, 2);
    memcpy(&m->magnetometer_channel_3_offset, b + 160, 2);
    memcpy(&m->magnetometer_sensitivity_s11, b + 162, 2);
    memcpy(&m->magnetometer_sensitivity_s22, b + 164, 2);
    memcpy(&m->magnetometer_sensitivity_s33, b + 166, 2);
    memcpy(&m->magnetometer_sensitivity_s12, b + 168, 2);
    memcpy(&m->magnetometer_sensitivity_s13, b + 170, 2);
    memcpy(&m->magnetometer_sensitivity_s21, b + 172, 2);
    memcpy(&m->magnetometer_sensitivity_s23, b + 174, 2);
    memcpy(&m->magnetometer_sensitivity_s31, b + 176, 2);
    memcpy(&m->magnetometer_sensitivity_s32, b + 178, 2);
    memcpy(&m->redundant_mag_mounting_alpha, b + 180, 2);
    memcpy(&m->redundant_mag_mounting_beta, b + 182, 2);
    memcpy(&m->redundant_mag_mounting_gamma, b + 184, 2);
    memcpy(&m->redundant_mag_channel_1_offset, b + 186, 2);
    memcpy(&m->redundant_mag_channel_2_offset, b + 188, 2);
    memcpy(&m->redundant_mag_channel_3_offset, b + 190, 2);
    memcpy(&m->redundant_mag_sensitivity_s11, b + 192, 2);
    memcpy(&m->redundant_mag_sensitivity_s22, b + 194, 2);
    memcpy(&m->redundant_mag_sensitivity_s33, b + 196, 2);
    memcpy(&m->redundant_mag_sensitivity_s12, b + 198, 2);
    memcpy(&m->redundant_mag_sensitivity_s13, b + 200, 2);
    memcpy(&m->redundant_mag_sensitivity_s21, b + 202, 2);
    memcpy(&m->redundant_mag_sensitivity_s23, b + 204, 2);
    memcpy(&m->redundant_mag_sensitivity_s31, b + 206, 2);
    memcpy(&m->redundant_mag_sensitivity_s32, b + 208, 2);
    memcpy(&m->star_tracker_mounting_alpha, b + 210, 2);
    memcpy(&m->star_tracker_mounting_beta, b + 212, 2);
    memcpy(&m->star_tracker_mounting_gamma, b + 214, 2);
    memcpy(&m->star_tracker_exposure_time, b + 216, 2);
    memcpy(&m->star_tracker_analog_gain, b + 218, 2);
    m->star_tracker_detection_threshold = b[220];
    m->star_tracker_star_threshold = b[221];
    m->maximum_star_matched = b[222];
    memcpy(&m->detection_timeout_duration, b + 223, 2);
    m->maximum_star_pixel = b[225];
    m->minimum_star_pixel = b[226];
    m->star_tracker_error_margin = b[227];
    memcpy(&m->star_tracker_delay_time, b + 228, 2);
    memcpy(&m->star_tracker_centroid_x, b + 230, 4);
    memcpy(&m->star_tracker_centroid_y, b + 234, 4);
    memcpy(&m->star_tracker_focal_length, b + 238, 4);
    memcpy(&m->k1_radial_distortion_coefficient, b + 242, 4);
    memcpy(&m->k2_radial_distortion_coefficient, b + 246, 4);
    memcpy(&m->p1_tangential_distortion_coefficient, b + 250, 4);
    memcpy(&m->p2_tangential_distortion_coefficient, b + 254, 4);
    m->star_tracking_window_width = b[258];
    m->star_tracking_margin = b[259];
    m->star_validation_margin = b[260];
    m->star_tracking_module_enable = (b[261] & 0x01) != 0;
    m->star_tracking_location_prediction_enable = (b[261] & 0x02) != 0;
    m->star_tracking_search_width = b[262];
    memcpy(&m->detumbling_spin_gain, b + 263, 4);
    memcpy(&m->detumbling_damping_gain, b + 267, 4);
    memcpy(&m->reference_spin_rate, b + 271, 2);
    memcpy(&m->fast_bdot_detumbling_gain, b + 273, 4);
    memcpy(&m->y_momentum_control_gain, b + 277, 4);
    memcpy(&m->y_momentum_nutation_damping_gain, b + 281, 4);
    memcpy(&m->y_momentum_proportional_gain, b + 285, 4);
    memcpy(&m->y_momentum_derivative_gain, b + 289, 4);
    memcpy(&m->reference_wheel_momentum, b + 293, 4);
    memcpy(&m->rwheel_proportional_gain, b + 297, 4);
    memcpy(&m->rwheel_derivative_gain, b + 301, 4);
    memcpy(&m->y_wheel_bias_momentum, b + 305, 4);
    m->sun_pointing_facet = b[309] & 0x7F;
    m->control_transition_on_wheel_error = (b[309] & 0x80) != 0;
    memcpy(&m->tracking_proportional_gain, b + 310, 4);
    memcpy(&m->tracking_derivative_gain, b + 314, 4);
    memcpy(&m->tracking_integral_gain, b + 318, 4);
    m->target_tracking_facet = b[322];
    memcpy(&m->moment_of_inertia_ixx, b + 323, 4);
    memcpy(&m->moment_of_inertia_iyy, b + 327, 4);
    memcpy(&m->moment_of_inertia_izz, b + 331, 4);
    memcpy(&m->product_of_inertia_ixy, b + 335, 4);
    memcpy(&m->product_of_inertia_ixz, b + 339, 4);
    memcpy(&m->product_of_inertia_iyz, b + 343, 4);
    memcpy(&m->magnetometer_rate_filter_system_noise, b + 347, 4);
    memcpy(&m->ekf_system_noise, b + 351, 4);
    memcpy(&m->css_measurement_noise, b + 355, 4);
    memcpy(&m->sun_sensor_measurement_noise, b + 359, 4);
    memcpy(&m->nadir_sensor_measurement_noise, b + 363, 4);
    memcpy(&m->magnetometer_measurement_noise, b + 367, 4);
    memcpy(&m->star_tracker_measurement_noise, b + 371, 4);
    m->use_sun_sensor = (b[375] & 0x01) != 0;
    m->use_nadir_sensor = (b[375] & 0x02) != 0;
    m->use_css = (b[375] & 0x04) != 0;
    m->use_star_tracker = (b[375] & 0x08) != 0;
    m->nadir_sensor_terminator_test = (b[375] & 0x10) != 0;
    m->automatic_magnetometer_recovery = (b[375] & 0x20) != 0;
    m->magnetometer_mode = b[375] >> 6;
    m->raw_magnetometer_selection = b[376] & 0x03;
    m->estimation_transition_on_rate_sensor_error = (b[376] & 0x04) != 0;
    m->cam1_period = b[377] & 0x0F;
    m->cam2_period = b[377] >> 4;
    memcpy(&m->incl_coefficient, b + 378, 2);
    memcpy(&m->raan_coefficient, b + 380, 2);
    memcpy(&m->ecc_coefficient, b + 382, 2);
    memcpy(&m->aop_coefficient, b + 384, 2);
    memcpy(&m->time_coefficient, b + 386, 2);
    memcpy(&m->pos_coefficient, b + 388, 2);
    m->maximum_position_error = b[390];
    m->asgp4_filter = b[391];
    memcpy(&m->xp_coefficient, b + 392, 4);
    memcpy(&m->yp_coefficient, b + 396, 4);
    m->gps_roll_over = b[400];
    m->position_sd = b[401];
    m->velocity_sd = b[402];
    m->min_satellites = b[403];
    m->time_gain = b[404];
    m->max_lag = b[405];
    memcpy(&m->min_samples, b + 406, 2);
    memcpy(m->user_coded_controller_settings, b + 408, 48);
    memcpy(m->user_coded_estimator_settings, b + 456, 48);
}

void hand_encode_206(const cubeacp_adcs_configuration_t *restrict m, uint8_t *restrict b);
void hand_encode_206(const cubeacp_adcs_configuration_t *restrict m, uint8_t *restrict b)
{
    b[0] = m->magnetorquer_1_configuration;
    b[1] = m->magnetorquer_2_configuration;
    b[2] = m->magnetorquer_3_configuration;
    b[3] = m->rw1_configuration;
    b[4] = m->rw2_configuration;
    b[5] = m->rw3_configuration;
    b[6] = m->rw4_configuration;
    b[7] = m->gyro1_configuration;
    b[8] = m->gyro2_configuration;
    b[9] = m->gyro3_configuration;
    memcpy(b + 10, &m->x_rate_sensor_offset, 2);
    memcpy(b + 12, &m->y_rate_sensor_offset, 2);
    memcpy(b + 14, &m->z_rate_sensor_offset, 2);
    b[16] = m->rate_sensor_mult;
    b[17] = m->css1_configuration;
    b[18] = m->css2_configuration;
    b[19] = m->css3_configuration;
    b[20] = m->css4_configuration;
    b[21] = m->css5_configuration;
    b[22] = m->css6_configuration;
    b[23] = m->css7_configuration;
    b[24] = m->css8_configuration;
    b[25] = m->css9_configuration;
    b[26] = m->css10_configuration;
    b[27] = m->css1_relative_scale;
    b[28] = m->css2_relative_scale;
    b[29] = m->css3_relative_scale;
    b[30] = m->css4_relative_scale;
    b[31] = m->css5_relative_scale;
    b[32] = m->css6_relative_scale;
    b[33] = m->css7_relative_scale;
    b[34] = m->css8_relative_scale;
    b[35] = m->css9_relative_scale;
    b[36] = m->css10_relative_scale;
    b[37] = m->css_threshold;
    memcpy(b + 38, &m->cam1_mounting_alpha, 2);
    memcpy(b + 40, &m->cam1_mounting_beta, 2);
    memcpy(b + 42, &m->cam1_mounting_gamma, 2);
    b[44] = m->cam1_detection_threshold;
    b[45] = (uint8_t)(m->cam1_sensor_auto_adjust_mode);
    memcpy(b + 46, &m->cam1_sensor_exposure_time, 2);
    memcpy(b + 48, &m->cam1_boresight_x, 2);
    memcpy(b + 50, &m->cam1_boresight_y, 2);
    memcpy(b + 52, &m->cam2_mounting_alpha, 2);
    memcpy(b + 54, &m->cam2_mounting_beta, 2);
    memcpy(b + 56, &m->cam2_mounting_gamma, 2);
    b[58] = m->cam2_detection_threshold;
    b[59] = (uint8_t)(m->cam2_sensor_auto_adjust_mode);
    memcpy(b + 60, &m->cam2_sensor_exposure_time, 2);
    memcpy(b + 62, &m->cam2_boresight_x, 2);
    memcpy(b + 64, &m->cam2_boresight_y, 2);
    b[66] = m->nadir_max_deviation_percentage;
    b[67] = m->nadir_max_bad_edges;
    b[68] = m->nadir_max_radius;
    b[69] = m->nadir_min_radius;
    memcpy(b + 70, &m->cam_1_minimum_x_of_area_1, 2);
    memcpy(b + 72, &m->cam_1_maximum_x_of_area_1, 2);
    memcpy(b + 74, &m->cam_1_minimum_y_of_area_1, 2);
    memcpy(b + 76, &m->cam_1_maximum_y_of_area_1, 2);
    memcpy(b + 78, &m->cam_1_minimum_x_of_area_2, 2);
    memcpy(b + 80, &m->cam_1_maximum_x_of_area_2, 2);
    memcpy(b + 82, &m->cam_1_minimum_y_of_area_2, 2);
    memcpy(b + 84, &m->cam_1_maximum_y_of_area_2, 2);
    memcpy(b + 86, &m->cam_1_minimum_x_of_area_3, 2);
    memcpy(b + 88, &m->cam_1_maximum_x_of_area_3, 2);
    memcpy(b + 90, &m->cam_1_minimum_y_of_area_3, 2);
    memcpy(b + 92, &m->cam_1_maximum_y_of_area_3, 2);
    memcpy(b + 94, &m->cam_1_minimum_x_of_area_4, 2);
    memcpy(b + 96, &m->cam_1_maximum_x_of_area_4, 2);
    memcpy(b + 98, &m->cam_1_minimum_y_of_area_4, 2);
    memcpy(b + 100, &m->cam_1_maximum_y_of_area_4, 2);
    memcpy(b + 102, &m->cam_1_minimum_x_of_area_5, 2);
    memcpy(b + 104, &m->cam_1_maximum_x_of_area_5, 2);
    memcpy(b + 106, &m->cam_1_minimum_y_of_area_5, 2);
    memcpy(b + 108, &m->cam_1_maximum_y_of_area_5, 2);
    memcpy(b + 110, &m->cam_2_minimum_x_of_area_1, 2);
    memcpy(b + 112, &m->cam_2_maximum_x_of_area_1, 2);
    memcpy(b + 114, &m->cam_2_minimum_y_of_area_1, 2);
    memcpy(b + 116, &m->cam_2_maximum_y_of_area_1, 2);
    memcpy(b + 118, &m->cam_2_minimum_x_of_area_2, 2);
    memcpy(b + 120, &m->cam_2_maximum_x_of_area_2, 2);
    memcpy(b + 122, &m->cam_2_minimum_y_of_area_2, 2);
    memcpy(b + 124, &m->cam_2_maximum_y_of_area_2, 2);
    memcpy(b + 126, &m->cam_2_minimum_x_of_area_3, 2);
    memcpy(b + 128, &m->cam_2_maximum_x_of_area_3, 2);
    memcpy(b + 130, &m->cam_2_minimum_y_of_area_3, 2);
    memcpy(b + 132, &m->cam_2_maximum_y_of_area_3, 2);
    memcpy(b + 134, &m->cam_2_minimum_x_of_area_4, 2);
    memcpy(b + 136, &m->cam_2_maximum_x_of_area_4, 2);
    memcpy(b + 138, &m->cam_2_minimum_y_of_area_4, 2);
    memcpy(b + 140, &m->cam_2_maximum_y_of_area_4, 2);
    memcpy(b + 142, &m->cam_2_minimum_x_of_area_5, 2);
    memcpy(b + 144, &m->cam_2_maximum_x_of_area_5, 2);
    memcpy(b + 146, &m->cam_2_minimum_y_of_area_5, 2);
    memcpy(b + 148, &m->cam_2_maximum_y_of_area_5, 2);
    memcpy(b + 150, &m->magnetometer_mounting_alpha, 2);
    memcpy(b + 152, &m->magnetometer_mounting_beta, 2);
    memcpy(b + 154, &m->magnetometer_mounting_gamma, 2);
    memcpy(b + 156, &m->magnetometer_channel_1_offset, 2);
    memcpy(b + 158, &m->magnetometer_channel_2_offset, 2);
    memcpy(b + 160, &m->magnetometer_channel_3_offset, 2);
    memcpy(b + 162, &m->magnetometer_sensitivity_s11, 2);
    memcpy(b + 164, &m->magnetometer_sensitivity_s22, 2);
    memcpy(b + 166, &m->magnetometer_sensitivity_s33, 2);
    memcpy(b + 168, &m->magnetometer_sensitivity_s12, 2);
    memcpy(b + 170, &m->magnetometer_sensitivity_s13, 2);
    memcpy(b + 172, &m->magnetometer_sensitivity_s21, 2);
    memcpy(b + 174, &m->magnetometer_sensitivity_s23, 2);
    memcpy(b + 176, &m->magnetometer_sensitivity_s31, 2);
    memcpy(b + 178, &m->magnetometer_sensitivity_s32, 2);
    memcpy(b + 180, &m->redundant_mag_mounting_alpha, 2);
    memcpy(b + 182, &m->redundant_mag_mounting_beta, 2);
    memcpy(b + 184, &m->redundant_mag_mounting_gamma, 2);
    memcpy(b + 186, &m->redundant_mag_channel_1_offset, 2);
    memcpy(b + 188, &m->redundant_mag_channel_2_offset, 2);
    memcpy(b + 190, &m->redundant_mag_channel_3_offset, 2);
    memcpy(b + 192, &m->redundant_mag_sensitivity_s11, 2);
    memcpy(b + 194, &m->redundant_mag_sensitivity_s22, 2);
    memcpy(b + 196, &m->redundant_mag_sensitivity_s33, 2);
    memcpy(b + 198, &m->redundant_mag_sensitivity_s12, 2);
    memcpy(b + 200, &m->redundant_mag_sensitivity_s13, 2);
    memcpy(b + 202, &m->redundant_mag_sensitivity_s21, 2);
    memcpy(b + 204, &m->redundant_mag_sensitivity_s23, 2);
    memcpy(b + 206, &m->redundant_mag_sensitivity_s31, 2);
    memcpy(b + 208, &m->redundant_mag_sensitivity_s32, 2);
    memcpy(b + 210, &m->star_tracker_mounting_alpha, 2);
    memcpy(b + 212, &m->star_tracker_mounting_beta, 2);
    memcpy(b + 214, &m->star_tracker_mounting_gamma, 2);
    memcpy(b + 216, &m->star_tracker_exposure_time, 2);
    memcpy(b + 218, &m->star_tracker_analog_gain, 2);
    b[220] = m->star_tracker_detection_threshold;
    b[221] = m->star_tracker_star_threshold;
    b[222] = m->maximum_star_matched;
    memcpy(b + 223, &m->detection_timeout_duration, 2);
    b[225] = m->maximum_star_pixel;
    b[226] = m->minimum_star_pixel;
    b[227] = m->star_tracker_error_margin;
    memcpy(b + 228, &m->star_tracker_delay_time, 2);
    memcpy(b + 230, &m->star_tracker_centroid_x, 4);
    memcpy(b + 234, &m->star_tracker_centroid_y, 4);
    memcpy(b + 238, &m->star_tracker_focal_length, 4);
    memcpy(b + 242, &m->k1_radial_distortion_coefficient, 4);
    memcpy(b + 246, &m->k2_radial_distortion_coefficient, 4);
    memcpy(b + 250, &m->p1_tangential_distortion_coefficient, 4);
    memcpy(b + 254, &m->p2_tangential_distortion_coefficient, 4);
    b[258] = m->star_tracking_window_width;
    b[259] = m->star_tracking_margin;
    b[260] = m->star_validation_margin;
    b[261] = (uint8_t)(m->star_tracking_module_enable | m->star_tracking_location_prediction_enable << 1);
    b[262] = m->star_tracking_search_width;
    memcpy(b + 263, &m->detumbling_spin_gain, 4);
    memcpy(b + 267, &m->detumbling_damping_gain, 4);
    memcpy(b + 271, &m->reference_spin_rate, 2);
    memcpy(b + 273, &m->fast_bdot_detumbling_gain, 4);
    memcpy(b + 277, &m->y_momentum_control_gain, 4);
    memcpy(b + 281, &m->y_momentum_nutation_damping_gain, 4);
    memcpy(b + 285, &m->y_momentum_proportional_gain, 4);
    memcpy(b + 289, &m->y_momentum_derivative_gain, 4);
    memcpy(b + 293, &m->reference_wheel_momentum, 4);
    memcpy(b + 297, &m->rwheel_proportional_gain, 4);
    memcpy(b + 301, &m->rwheel_derivative_gain, 4);
    memcpy(b + 305, &m->y_wheel_bias_momentum, 4);
    b[309] = (uint8_t)(m->sun_pointing_facet | m->control_transition_on_wheel_error << 7);
    memcpy(b + 310, &m->tracking_proportional_gain, 4);
    memcpy(b + 314, &m->tracking_derivative_gain, 4);
    memcpy(b + 318, &m->tracking_integral_gain, 4);
    b[322] = m->target_tracking_facet;
    memcpy(b + 323, &m->moment_of_inertia_ixx, 4);
    memcpy(b + 327, &m->moment_of_inertia_iyy, 4);
    memcpy(b + 331, &m->moment_of_inertia_izz, 4);
    memcpy(b + 335, &m->product_of_inertia_ixy, 4);
    memcpy(b + 339, &m->product_of_inertia_ixz, 4);
    memcpy(b + 343, &m->product_of_inertia_iyz, 4);
    memcpy(b + 347, &m->magnetometer_rate_filter_system_noise, 4);
    memcpy(b + 351, &m->ekf_system_noise, 4);
    memcpy(b + 355, &m->css_measurement_noise, 4);
    memcpy(b + 359, &m->sun_sensor_measurement_noise, 4);
    memcpy(b + 363, &m->nadir_sensor_measurement_noise, 4);
    memcpy(b + 367, &m->magnetometer_measurement_noise, 4);
    memcpy(b + 371, &m->star_tracker_measurement_noise, 4);
    b[375] = (uint8_t)(m->use_sun_sensor | m->use_nadir_sensor << 1 | m->use_css << 2 | m->use_star_tracker << 3 |
                       m->nadir_sensor_terminator_test << 4 | m->automatic_magnetometer_recovery << 5 |
                       m->magnetometer_mode << 6);
    b[376] = (uint8_t)(m->raw_magnetometer_selection | m->estimation_transition_on_rate_sensor_error << 2);
    b[377] = (uint8_t)(m->cam1_period | (m->cam2_period << 4));
    memcpy(b + 378, &m->incl_coefficient, 2);
    memcpy(b + 380, &m->raan_coefficient, 2);
    memcpy(b + 382, &m->ecc_coefficient, 2);
    memcpy(b + 384, &m->aop_coefficient, 2);
    memcpy(b + 386, &m->time_coefficient, 2);
    memcpy(b + 388, &m->pos_coefficient, 2);
    b[390] = m->maximum_position_error;
    b[391] = m->asgp4_filter;
    memcpy(b + 392, &m->xp_coefficient, 4);
    memcpy(b + 396, &m->yp_coefficient, 4);
    b[400] = m->gps_roll_over;
    b[401] = m->position_sd;
    b[402] = m->velocity_sd;
    b[403] = m->min_satellites;
    b[404] = m->time_gain;
    b[405] = m->max_lag;
    memcpy(b + 406, &m->min_samples, 2);
    memcpy(b + 408, m->user_coded_controller_settings, 48);
    memcpy(b + 456, m->user_coded_estimator_settings, 48);
}

void hand_decode_207(cubeacp_sgp4_orbit_parameters_t *restrict m, const uint8_t *restrict b);
void hand_decode_207(cubeacp_sgp4_orbit_parameters_t *restrict m, const uint8_t *restrict b)
{
    memcpy(&m->inclination, b + 0, 8);
    memcpy(&m->eccentricity, b + 8, 8);
    memcpy(&m->right_ascension_of_the_ascending_node, b + 16, 8);
    memcpy(&m->argument_of_perigee, b + 24, 8);
    memcpy(&m->b_star_drag_term, b + 32, 8);
    memcpy(&m->mean_motion, b + 40, 8);
    memcpy(&m->mean_anomaly, b + 48, 8);
    memcpy(&m->epoch, b + 56, 8);
}

void hand_encode_207(const cubeacp_sgp4_orbit_parameters_t *restrict m, uint8_t *restrict b);
void hand_encode_207(const cubeacp_sgp4_orbit_parameters_t *restrict m, uint8_t *restrict b)
{
    memcpy(b + 0, &m->inclination, 8);
    memcpy(b + 8, &m->eccentricity, 8);
    memcpy(b + 16, &m->right_ascension_of_the_ascending_node, 8);
    memcpy(b + 24, &m->argument_of_perigee, 8);
    memcpy(b + 32, &m->b_star_drag_term, 8);
    memcpy(b + 40, &m->mean_motion, 8);
    memcpy(b + 48, &m->mean_anomaly, 8);
    memcpy(b + 56, &m->epoch, 8);
}

void hand_decode_146(cubeacp_estimated_attitude_angles_t *restrict m, const uint8_t *restrict b);
void hand_decode_146(cubeacp_estimated_attitude_angles_t *restrict m, const uint8_t *restrict b)
{
    memcpy(&m->estimated_roll_angle, b + 0, 2);
    memcpy(&m->estimated_pitch_angle, b + 2, 2);
    memcpy(&m->estimated_yaw_angle, b + 4, 2);
}

void hand_encode_146(const cubeacp_estimated_attitude_angles_t *restrict m, uint8_t *restrict b);
void hand_encode_146(const cubeacp_estimated_attitude_angles_t *restrict m, uint8_t *restrict b)
{
    memcpy(b + 0, &m->estimated_roll_angle, 2);
    memcpy(b + 2, &m->estimated_pitch_angle, 2);
    memcpy(b + 4, &m->estimated_yaw_angle, 2);
}
