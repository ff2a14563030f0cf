import java.io.BufferedReader;
import java.io.InputStreamReader;
import java.nio.file.Files;
import java.util.ArrayList;
import java.util.HashMap;
import java.util.HexFormat;
import java.util.List;
import java.util.Map;
import org.yamcs.ProcessorConfig;
import org.yamcs.YConfiguration;
import org.yamcs.mdb.Mdb;
import org.yamcs.mdb.MdbFactory;
import org.yamcs.mdb.MetaCommandProcessor;
import org.yamcs.mdb.ProcessorData;
import org.yamcs.mdb.XtceTmExtractor;
import org.yamcs.parameter.AggregateValue;
import org.yamcs.parameter.ParameterValue;
import org.yamcs.parameter.Value;
import org.yamcs.xtce.Argument;
import org.yamcs.xtce.MetaCommand;
import org.yamcs.xtce.SequenceContainer;

/**
 * Loads files of XTCE as one database. Prints each command with its packet, arguments that are free being 2; then of each line of
 * the input, a packet in hexadecimal, the parameters with raw values. The first argument names the outermost container.
 */
public class Shapes {
    public static void main(String[] args) throws Exception {
        YConfiguration.setupTest(null);
        MdbFactory.setupTool(Files.createTempDirectory("mdb"));
        List<YConfiguration> files = new ArrayList<>();
        for (int number = 1; number < args.length; number++) {
            files.add(YConfiguration.wrap(Map.of("type", "xtce", "args", Map.of("file", args[number]))));
        }
        Mdb mdb = MdbFactory.createInstance(files, false, false);
        MetaCommandProcessor commands = new MetaCommandProcessor(new ProcessorData("test", "test", mdb, new ProcessorConfig()));
        for (MetaCommand one : mdb.getMetaCommands()) {
            if (one.isAbstract()) {
                continue;
            }
            Map<String, Object> values = new HashMap<>();
            for (Argument argument : one.getArgumentList() == null ? List.<Argument>of() : one.getArgumentList()) {
                values.put(argument.getName(), 2);
            }
            byte[] packet = commands.buildCommand(one, values, 0L).getCmdPacket();
            System.out.println("command\t" + one.getName() + "\t" + HexFormat.of().formatHex(packet));
        }
        SequenceContainer root = mdb.getSequenceContainers().stream().filter(c -> c.getName().equals(args[0])).findFirst().get();
        XtceTmExtractor extractor = new XtceTmExtractor(mdb);
        extractor.provideAll();
        BufferedReader in = new BufferedReader(new InputStreamReader(System.in));
        for (String line; (line = in.readLine()) != null;) {
            StringBuilder text = new StringBuilder("telemetry");
            for (ParameterValue one : extractor.processPacket(HexFormat.of().parseHex(line), 0L, 0L, 0, root).getParameterResult()) {
                print(text, one.getParameter().getName(), one.getRawValue());
            }
            System.out.println(text);
        }
    }

    private static void print(StringBuilder text, String name, Value value) {
        if (value instanceof AggregateValue aggregate) {
            for (int index = 0; index < aggregate.numMembers(); index++) {
                print(text, name + " " + aggregate.getMemberName(index), aggregate.getMemberValue(index));
            }
        } else {
            text.append('\t').append(name).append('=').append(value);
        }
    }
}
