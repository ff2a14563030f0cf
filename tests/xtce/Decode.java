import java.io.BufferedReader;
import java.io.InputStreamReader;
import java.nio.file.Files;
import java.util.HexFormat;
import java.util.List;
import java.util.Map;
import org.yamcs.YConfiguration;
import org.yamcs.mdb.Mdb;
import org.yamcs.mdb.MdbFactory;
import org.yamcs.mdb.XtceTmExtractor;
import org.yamcs.parameter.ParameterValue;
import org.yamcs.protobuf.Yamcs.Value.Type;
import org.yamcs.xtce.SequenceContainer;

/** Loads a file of XTCE; of each line of the input, hexadecimal, prints the parameters with raw and engineering values. */
public class Decode {
    public static void main(String[] args) throws Exception {
        YConfiguration.setupTest(null);
        MdbFactory.setupTool(Files.createTempDirectory("mdb"));
        Map<String, Object> file = Map.of("type", "xtce", "args", Map.of("file", args[0]));
        Mdb mdb = MdbFactory.createInstance(List.of(YConfiguration.wrap(file)), false, false);
        SequenceContainer root = mdb.getSequenceContainers().stream().filter(c -> c.getName().equals("TelemetryFrame")).findFirst().get();
        XtceTmExtractor extractor = new XtceTmExtractor(mdb);
        extractor.provideAll();
        BufferedReader in = new BufferedReader(new InputStreamReader(System.in));
        for (String line; (line = in.readLine()) != null;) {
            var result = extractor.processPacket(HexFormat.of().parseHex(line), 0L, 0L, 0, root);
            StringBuilder text = new StringBuilder();
            for (ParameterValue one : result.getParameterResult()) {
                boolean isText = one.getRawValue() != null && one.getRawValue().getType() == Type.STRING;
                String values = isText ? "|" : (one.getRawValue() + "|" + one.getEngValue()).replaceAll("[^ -~]", "?");
                text.append(one.getParameter().getName()).append('=').append(values).append('\t');
            }
            System.out.println(text);
        }
    }
}
