#include "mistral.h"
#include "port.h"

static void at_once(void *context, const icd_event_t *event) /* CONTROL is acknowledged: nothing ends at once */
{
    (void)context;
    (void)event;
}

int main(int argc, char **argv)
{
    static icd_client_t client;
    static uint8_t buffer[MISTRAL_CLIENT_BYTES], frame[MISTRAL_LONGEST];
    const mistral_control_t control = {.run = true, .rate = 4};
    mistral_speed_t speed;
    icd_event_t end;
    const int port = port_open("127.0.0.1", argc > 1 ? argv[1] : "4000");
    icd_client_init(&client, mistral_link(), ICD_BUS_UART, buffer, sizeof buffer);

    mistral_control_encode(&control, frame, sizeof frame);
    icd_client_send(
        &client, port_now(), MISTRAL_CONTROL_SET_ID, frame, MISTRAL_CONTROL_LENGTH, true, at_once, NULL);
    end = port_ask(port, &client, frame, sizeof frame); /* sends, waits, asks again */
    printf("the sensor %s\n", end.kind == ICD_EVENT_DONE ? "runs" : "does not run");

    ICD_REQUEST(&client, port_now(), MISTRAL_SPEED);
    end = port_ask(port, &client, frame, sizeof frame);
    if (mistral_speed_decode(&speed, frame, end.length) != ICD_OK) {
        return fprintf(stderr, "no reply\n"), 1;
    }
    printf("%.1f m/s\n", mistral_speed_speed_m_per_s(&speed));
    return 0;
}
