import java.io.ByteArrayOutputStream;
import java.io.File;
import java.io.IOException;
import java.io.PrintStream;
import java.nio.file.Files;
import java.nio.file.Path;
import java.util.ArrayList;
import java.util.Arrays;
import java.util.LinkedHashMap;
import java.util.List;
import java.util.Map;
import java.util.TreeSet;
import java.util.concurrent.Callable;
import java.util.concurrent.Executors;
import java.util.concurrent.Future;
import java.util.concurrent.TimeUnit;
import java.util.regex.Pattern;
import java.util.stream.Collectors;
import java.util.stream.Stream;
import org.jetbrains.kotlin.cli.common.ExitCode;
import org.jetbrains.kotlin.cli.jvm.K2JVMCompiler;
import org.junit.platform.engine.TestExecutionResult;
import org.junit.platform.engine.discovery.DiscoverySelectors;
import org.junit.platform.launcher.TestExecutionListener;
import org.junit.platform.launcher.TestIdentifier;
import org.junit.platform.launcher.core.LauncherDiscoveryRequestBuilder;
import org.junit.platform.launcher.core.LauncherFactory;

/**
 * Breaks the Kotlin library on purpose, one patch of patches.txt at a time in a copy, and expects the tests that the patch names to fail. One
 * compiler, kept warm, compiles the patched file alone, or its module; each patch's tests run in a process of their own, two at a time. tests/mutants.sh starts it.
 */
public class Mutants {
    record Patch(String file, List<String> tests, String what, String old, String with) {}

    record Module(String name, List<String> sources, List<String> options) {}

    private static final Path ROOT = Path.of(System.getProperty("repository.root"));
    private static final Path WORK = Path.of(System.getProperty("work"));
    private static final Path ANDROID = ROOT.resolve("android");
    private static final List<Module> MODULES = List.of(
        new Module("bindings", List.of("android/bindings/src/main/kotlin", "bindings/kotlin"), List.of()),
        new Module("library", List.of("android/library/src/main/kotlin"), List.of()),
        new Module("compose", List.of("android/compose/src/main/kotlin", "android/compose/src/maven/kotlin"),
            List.of("-Xplugin=" + System.getProperty("compose.plugin"))),
        new Module("sample", List.of("android/sample/src/main/kotlin", "android/compose/src/main/kotlin", "android/compose/src/maven/kotlin"),
            List.of("-Xplugin=" + System.getProperty("compose.plugin"))));
    private static final long MOST_SECONDS = 120;

    public static void main(String[] arguments) throws Exception {
        List<Patch> patches = read(Path.of(System.getProperty("patches")));
        Pattern word = Pattern.compile(arguments.length > 0 ? arguments[0] : "", Pattern.CASE_INSENSITIVE);
        patches = patches.stream().filter(it -> word.matcher(it.file + " " + it.tests + " " + it.what).find()).toList();
        if (patches.isEmpty()) throw new IllegalArgumentException("no patch has the word '" + word + "'");
        for (Module module : MODULES) READ.put(module, read(module));
        var tests = new TreeSet<String>();
        patches.forEach(it -> tests.addAll(it.tests));
        System.out.println(patches.size() + " patches; without any, " + tests.size() + " test classes have to pass");
        for (Module module : MODULES) {
            List<String> own = tests.stream().filter(it -> classOf(module, it) != null).toList();
            String said = own.isEmpty() ? "passed" : run(module, null, own);
            if (!said.equals("passed")) throw new IllegalStateException("without a patch: " + said);
        }
        var workers = Executors.newFixedThreadPool(2);
        var results = new ArrayList<Future<String>>();
        for (Patch patch : patches) results.add(workers.submit((Callable<String>) () -> broken(patch)));
        int survivors = 0;
        for (int k = 0; k < patches.size(); k++) {
            String said = results.get(k).get();
            if (said.equals("passed")) survivors += 1;
            System.out.printf("%-9s %-22s %s%s%n", said.equals("passed") ? "SURVIVED" : "killed", patches.get(k).file, patches.get(k).what,
                said.equals("passed") ? "" : "  [" + said + "]");
        }
        workers.shutdown();
        System.out.println(patches.size() + " patches, " + survivors + " survived");
        System.exit(survivors == 0 ? 0 : 1);
    }

    /** `@ File Test Test: what it breaks`, then the lines that are there, each after `- `, and those in their place, each after `+ ` (none: `+`). */
    private static List<Patch> read(Path table) throws IOException {
        var found = new ArrayList<Patch>();
        for (String block : Files.readString(table).split("\n(?=@ )")) {
            if (!block.startsWith("@ ")) continue;
            List<String> lines = block.lines().toList();
            String[] head = lines.get(0).substring(2).split(": ", 2);
            List<String> names = Arrays.asList(head[0].split(" "));
            found.add(new Patch(names.get(0), names.subList(1, names.size()), head[1], part(lines, "-"), part(lines, "+")));
        }
        return found;
    }

    private static String part(List<String> lines, String mark) {
        return lines.stream().filter(it -> it.equals(mark) || it.startsWith(mark + " "))
            .map(it -> it.substring(Math.min(2, it.length()))).collect(Collectors.joining("\n"));
    }

    /** What the tests say of a patch. */
    private static String broken(Patch patch) throws Exception {
        for (Module module : MODULES) {
            Map<Path, String> sources = new LinkedHashMap<>(READ.get(module));
            Path file = sources.keySet().stream().filter(it -> it.endsWith(patch.file + ".kt")).findFirst().orElse(null);
            if (file == null) continue;
            String text = sources.get(file);
            int at = text.indexOf(patch.old);
            if (at < 0 || text.indexOf(patch.old, at + 1) >= 0) {
                throw new IllegalStateException(patch.file + ": what '" + patch.what + "' takes out is not there exactly once: " + patch.old);
            }
            String broken = text.substring(0, at) + patch.with + text.substring(at + patch.old.length());
            sources.put(file, broken);
            Path classes = compile(module, COPIED_BY_OTHERS.matcher(broken).find() ? sources : Map.of(file, broken), patch);
            Module of = MODULES.stream().filter(it -> classOf(it, patch.tests.get(0)) != null).findFirst()
                .orElseThrow(() -> new IllegalStateException("no test class " + patch.tests));
            return run(of, classes, patch.tests);
        }
        throw new IllegalStateException("no source " + patch.file + ".kt");
    }

    /** What stands in the classes of other files too: an inline function, and a class of several files. A file without is compiled alone. */
    private static final Pattern COPIED_BY_OTHERS = Pattern.compile("^ *(internal |public )?inline |JvmMultifileClass", Pattern.MULTILINE);

    /** As they were when all began: who edits meanwhile changes nothing here. */
    private static final Map<Module, Map<Path, String>> READ = new LinkedHashMap<>();

    private static Map<Path, String> read(Module module) throws IOException {
        var found = new LinkedHashMap<Path, String>();
        for (String folder : module.sources) {
            try (Stream<Path> files = Files.walk(ROOT.resolve(folder))) {
                for (Path file : files.filter(it -> it.toString().endsWith(".kt")).sorted().toList()) found.put(file, Files.readString(file));
            }
        }
        return found;
    }

    /** One at a time: the compiler shares what it has read. */
    private static synchronized Path compile(Module module, Map<Path, String> sources, Patch patch) throws IOException {
        Path folder = Files.createTempDirectory(WORK, "patched");
        Path classes = folder.resolve("classes");
        var files = new ArrayList<String>();
        for (var source : sources.entrySet()) {
            Path copy = folder.resolve("src").resolve(ROOT.relativize(source.getKey()));
            Files.createDirectories(copy.getParent());
            Files.writeString(copy, source.getValue());
            files.add(copy.toString());
        }
        var arguments = new ArrayList<>(List.of("-d", classes.toString(), "-module-name", "magcomp-" + module.name, "-jvm-target", "1.8", "-nowarn",
            "-no-stdlib", "-no-reflect", "-Xexplicit-api=disable", "-cp", classpath(module), friends(module)));
        arguments.addAll(module.options);
        arguments.addAll(files);
        var said = new ByteArrayOutputStream();
        ExitCode code = new K2JVMCompiler().exec(new PrintStream(said), arguments.toArray(new String[0]));
        if (code != ExitCode.OK) throw new IllegalStateException("'" + patch.what + "' does not compile:\n" + said);
        return classes;
    }

    /** Whose internal names it sees: those of its own other files, and of the bindings, as in the published AAR. */
    private static String friends(Module module) {
        return Stream.of(module.name, "bindings").distinct().map(it -> ANDROID.resolve(it + "/target/classes").toString())
            .collect(Collectors.joining(",", "-Xfriend-paths=", ""));
    }

    private static String classpath(Module module) {
        try {
            // what javac made of the module itself, such as its R
            return ANDROID.resolve(module.name + "/target/classes") + File.pathSeparator
                + Files.readString(ANDROID.resolve(module.name + "/target/classpath.txt")).trim();
        } catch (IOException e) {
            throw new IllegalStateException(e);
        }
    }

    private static String classOf(Module module, String test) {
        Path folder = ANDROID.resolve(module.name + "/target/test-classes");
        if (!Files.isDirectory(folder)) return null;
        try (Stream<Path> files = Files.walk(folder)) {
            return files.filter(it -> it.endsWith(test + ".class")).findFirst()
                .map(it -> folder.relativize(it).toString().replace(".class", "").replace(File.separatorChar, '.')).orElse(null);
        } catch (IOException e) {
            throw new IllegalStateException(e);
        }
    }

    /** Runs tests of a module, with patched classes before all others: "passed", or which failed first, or that they hang. */
    private static String run(Module module, Path patched, List<String> tests) throws Exception {
        String path = (patched == null ? "" : patched + File.pathSeparator) + ANDROID.resolve(module.name + "/target/test-classes")
            + File.pathSeparator + classpath(module) + File.pathSeparator + System.getProperty("runner.path");
        var command = new ArrayList<>(List.of(System.getProperty("java.home") + "/bin/java", "-Xmx512m", "-XX:TieredStopAtLevel=1", "-XX:+UseSerialGC",
            "-Djava.awt.headless=true"));
        for (String name : List.of("repository.root", "rust.expected", "java.library.path", "jna.library.path")) {
            command.add("-D" + name + "=" + System.getProperty(name));
        }
        command.add("-Dpicture=" + Files.createTempFile(WORK, "picture", ".png"));
        command.addAll(List.of("-cp", path, "Mutants$Runner"));
        for (String test : tests) {
            String name = classOf(module, test);
            if (name == null) throw new IllegalStateException("no test class " + test);
            command.add(name);
        }
        Path said = Files.createTempFile(WORK, "tests", ".txt");
        Process process = new ProcessBuilder(command).redirectErrorStream(true).redirectOutput(said.toFile()).start();
        Runtime.getRuntime().addShutdownHook(new Thread(process::destroyForcibly));
        long most = patched == null ? 10 * MOST_SECONDS : MOST_SECONDS;
        if (!process.waitFor(most, TimeUnit.SECONDS)) {
            process.destroyForcibly().waitFor();
            return "hangs";
        }
        if (process.exitValue() == 0) return "passed";
        return Files.readAllLines(said).stream().filter(it -> it.startsWith("FAILED ")).map(it -> it.substring(7)).findFirst()
            .orElseThrow(() -> new IllegalStateException("the tests did not run, see " + said));
    }

    /** In the process of the tests: ends with the first that fails. */
    public static class Runner {
        private static int passed;

        public static void main(String[] classes) {
            var request = LauncherDiscoveryRequestBuilder.request()
                .configurationParameter("junit.jupiter.execution.timeout.default", "60 s")
                .configurationParameter("junit.jupiter.execution.timeout.thread.mode.default", "SEPARATE_THREAD");
            for (String name : classes) request.selectors(DiscoverySelectors.selectClass(name));
            LauncherFactory.create().execute(request.build(), new TestExecutionListener() {
                @Override
                public void executionFinished(TestIdentifier test, TestExecutionResult result) {
                    if (result.getStatus() != TestExecutionResult.Status.FAILED) {
                        if (test.isTest()) passed += 1;
                        return;
                    }
                    try {
                        System.out.println("\nFAILED " + test.getDisplayName() + result.getThrowable().map(Runner::firstLine).orElse(""));
                    } finally {
                        Runtime.getRuntime().halt(1);
                    }
                }
            });
            Runtime.getRuntime().halt(passed > 0 ? 0 : 2);
        }

        private static String firstLine(Throwable error) {
            String line = ": " + error.toString().lines().findFirst().orElse("");
            return line.substring(0, Math.min(100, line.length()));
        }
    }
}
