/* What stands on the page about the API, between [key] and []: it is built and run by a test. */
#include "imu.h"

#define CHECK(what)          \
    do {                     \
        if (!(what)) {       \
            return __LINE__; \
        }                    \
    } while (0)

static const uint8_t frame[] = {0x2e, 0xfb, 0x0a, 0x00, 0xd7, 0x00, 0xfb, 0xff, 'I', 'M', 'U', 0x00, 0x11, 0x52, 0x64, 0x00};
static imu_state_t came;

static void on_event(void *context, const icd_event_t *event)
{
    imu_state_t state;
    icd_status_t status;
    (void)context;
    /* [receive] */
    status = imu_receive_state(&state, event);
    /* [] */
    if (status == ICD_OK) {
        came = state;
    }
}

int main(void)
{
    imu_state_t state;
    imu_setup_t setup;
    imu_attitude_t attitude;
    imu_climate_t climate;
    imu_telemetry_t any;
    imu_client_t client;
    icd_status_t status;
    icd_slot_t slots[1];
    uint8_t buffer[IMU_CLIENT_BYTES], line[32], written[IMU_STATE_LENGTH];
    const uint8_t received[] = {0x10, 0x02, 0x83, 0x2e, 0xfb, 0x0a, 0x00, 0xd7, 0x00, 0xfb, 0xff,
                                'I',  'M',  'U',  0x00, 0x11, 0x52, 0x64, 0x00, 0x10, 0x03};
    const char *text, *unit;
    char label[5];
    size_t count, length;
    uint32_t now = 0u, place;
    double value;
    int32_t thousandths, number;
    unsigned raw;
    bool holds;

    /* [new] */
    imu_setup_init(&setup);
    /* [] */
    CHECK(setup.rate == 0u);
    /* [decode] */
    status = imu_state_decode(&state, frame, sizeof frame);
    /* [] */
    CHECK(status == ICD_OK && state.pitch == 10);
    /* [encode] */
    status = imu_state_encode(&state, written, sizeof written);
    /* [] */
    CHECK(status == ICD_OK && memcmp(written, frame, sizeof frame) == 0);
    setup.timeout = 4096u;
    /* [valid] */
    text = imu_setup_misfit(&setup);
    /* [] */
    CHECK(text != NULL && strcmp(text, "Timeout") == 0);
    setup.timeout = 0u;
    /* [name] */
    text = imu_telemetry_name(IMU_STATE_ID);
    /* [] */
    CHECK(strcmp(text, "State") == 0);
    /* [ids] */
    const unsigned ids[] = {IMU_SETUP_SET_ID, IMU_SETUP_GET_ID, IMU_STATE_ID};
    /* [] */
    CHECK(ids[0] == 20u && ids[1] == 132u && ids[2] == 131u);
    /* [length] */
    length = IMU_STATE_LENGTH;
    /* [] */
    CHECK(length == sizeof frame);
    /* [dispatch] */
    status = imu_telemetry_decode(&any, 131u, frame, sizeof frame);
    /* [] */
    CHECK(status == ICD_OK && any.id == IMU_STATE_ID && any.as.state.pitch == 10);
    /* [part] */
    imu_state_part_attitude(&state, &attitude);
    /* [] */
    CHECK(attitude.roll == -1234 && attitude.pitch == 10);

    /* [get] */
    number = state.roll;
    /* [] */
    CHECK(number == -1234);
    /* [set] */
    state.pitch = 20;
    /* [] */
    CHECK(state.pitch == 20);
    /* [physical] */
    value = imu_state_roll_deg(&state);
    /* [] */
    CHECK((value > -12.345) && (value < -12.335));
    /* [set_physical] */
    status = imu_state_set_roll_deg(&state, 12.5);
    /* [] */
    CHECK(status == ICD_OK && state.roll == 1250);
    CHECK(imu_state_set_roll_deg(&state, 400.0) == ICD_ERROR_RANGE);
    /* [exact] */
    thousandths = imu_state_roll_mdeg(&state);
    /* [] */
    CHECK(thousandths == 12500);
    /* [set_exact] */
    status = imu_state_set_roll_mdeg(&state, -12340);
    /* [] */
    CHECK(status == ICD_OK && state.roll == -1234);
    /* [enum] */
    holds = state.mode == IMU_MODE_ACTIVE;
    /* [] */
    CHECK(holds);
    /* [set_enum] */
    state.mode = IMU_MODE_IDLE;
    /* [] */
    CHECK(state.mode == 0u);
    /* [enum_name] */
    text = imu_mode_name(state.mode);
    /* [] */
    CHECK(strcmp(text, "Idle") == 0);
    /* [flag] */
    holds = state.valid;
    /* [] */
    CHECK(holds);
    /* [divided] */
    raw = state.slow_period;
    /* [] */
    CHECK(raw == 5u && state.fast_period == 2u);
    /* [array] */
    number = state.heat[1];
    /* [] */
    CHECK(number == -5);
    /* [array_physical] */
    status = imu_state_heat_c(&state, 1, &value);
    /* [] */
    CHECK(status == ICD_OK && (value > -0.51) && (value < -0.49));
    /* [set_array] */
    status = imu_state_set_heat_c(&state, 1, 30.0);
    /* [] */
    CHECK(status == ICD_OK && state.heat[1] == 300);
    /* [text] */
    status = imu_state_label_text(&state, label, sizeof label);
    /* [] */
    CHECK(status == ICD_OK && strcmp(label, "IMU") == 0);
    /* [set_text] */
    status = imu_state_set_label_text(&state, "AHRS");
    /* [] */
    CHECK(status == ICD_OK && memcmp(state.label, "AHRS", 4u) == 0);
    /* [view] */
    raw = imu_state_status(&state);
    /* [] */
    CHECK(raw == 0x10u);

    /* [fields] */
    const icd_field_t *fields = imu_setup_fields(&count);
    /* [] */
    CHECK(count == 2u);
    /* [field_name] */
    text = fields[0].name;
    /* [] */
    CHECK(strcmp(text, "Rate") == 0);
    /* [unit] */
    unit = fields[0].unit;
    /* [] */
    CHECK(strcmp(unit, "Hz") == 0);
    /* [place] */
    place = fields[0].at + fields[0].bits;
    /* [] */
    CHECK(place == 16u);
    /* [limits] */
    value = fields[0].limits[1].value;
    /* [] */
    CHECK(fields[0].limits[1].kind == ICD_LIMIT_MAX && (value > 399.9) && (value < 400.1));
    /* [allows] */
    holds = icd_allows(&fields[0], 400.5);
    /* [] */
    CHECK(!holds && icd_allows(&fields[0], 400.0) && !icd_allows(&fields[0], 0.5) && icd_allows(&fields[1], 1e9));
    /* [limit] */
    value = IMU_SETUP_RATE_HZ_MAX;
    /* [] */
    CHECK((value > 399.9) && (value < 400.1));
    /* [special] */
    setup.timeout = IMU_SETUP_TIMEOUT_NEVER;
    /* [] */
    CHECK(setup.timeout == 4095u);
    imu_climate_init(&climate);
    CHECK(!icd_is_special_f32(climate.pressure, IMU_CLIMATE_PRESSURE_NOT_KNOWN));
    climate.pressure = IMU_CLIMATE_PRESSURE_NOT_KNOWN;
    /* [nan] */
    holds = icd_is_special_f32(climate.pressure, IMU_CLIMATE_PRESSURE_NOT_KNOWN);
    /* [] */
    CHECK(holds);

    /* [client] */
    status = imu_client_uart(&client, slots, 1, buffer, sizeof buffer);
    /* [] */
    CHECK(status == ICD_OK);
    /* [request] */
    status = imu_request_state(&client, now);
    /* [] */
    CHECK(status == ICD_OK);
    length = 0u;
    /* [output] */
    while (icd_client_output(&client.client, line, sizeof line, &count)) {
        length += count;
    }
    /* [] */
    CHECK(length == 5u);
    /* [received] */
    icd_client_received(&client.client, now, received, sizeof received, on_event, NULL);
    /* [] */
    CHECK(came.roll == -1234);
    /* [send] */
    status = imu_send_setup(&client, now, &setup);
    /* [] */
    CHECK(status == ICD_OK);
    return 0;
}
