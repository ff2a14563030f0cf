#include "mistral.h"
#include "port.h"

int main(int argc, char **argv)
{
    static mistral_client_t wind;
    static icd_slot_t slots[1]; /* one request at a time */
    static uint8_t buffer[MISTRAL_CLIENT_BYTES], frame[MISTRAL_LONGEST];
    const mistral_control_t control = {.run = true, .rate = 4};
    mistral_speed_t speed;
    icd_event_t end;
    const int port = port_open("127.0.0.1", argc > 1 ? argv[1] : "4000");
    mistral_client_uart(&wind, slots, 1, buffer, sizeof buffer);

    mistral_send_control(&wind, port_now(), &control);
    end = port_ask(port, &wind.client, frame, sizeof frame); /* sends, waits, asks again */
    printf("the sensor %s\n", end.kind == ICD_EVENT_DONE ? "runs" : "does not run");

    mistral_request_speed(&wind, port_now());
    end = port_ask(port, &wind.client, frame, sizeof frame);
    if (mistral_receive_speed(&speed, &end) != ICD_OK) {
        return fprintf(stderr, "no reply\n"), 1;
    }
    printf("%.1f m/s\n", mistral_speed_speed_m_per_s(&speed));
    return 0;
}
