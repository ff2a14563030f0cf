#include "port.h"
#include "sirocco.h"

int main(int argc, char **argv)
{
    static sirocco_client_t fan;
    static icd_slot_t slots[1]; /* one request at a time */
    static uint8_t buffer[SIROCCO_CLIENT_BYTES], frame[SIROCCO_LONGEST];
    sirocco_fan_state_t state;
    icd_event_t end;
    const int port = port_open("127.0.0.1", argc > 1 ? argv[1] : "4000");
    sirocco_client_uart(&fan, slots, 1, buffer, sizeof buffer);

    sirocco_request_fan_state(&fan, port_now());
    end = port_ask(port, &fan.client, frame, sizeof frame); /* sends, waits, asks again */
    if (sirocco_receive_fan_state(&state, &end) != ICD_OK) {
        return fprintf(stderr, "no reply\n"), 1;
    }
    printf("%.1f rpm, %.0f mA, bearing %.2f C\n", sirocco_fan_state_speed_rpm(&state),
           sirocco_fan_state_current_ma(&state), sirocco_fan_state_bearing_temperature_c(&state));
    return 0;
}
