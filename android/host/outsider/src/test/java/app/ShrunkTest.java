package app;

import static org.junit.jupiter.api.Assertions.assertEquals;
import static org.junit.jupiter.api.Assertions.assertTrue;

import java.io.File;
import java.nio.file.Files;
import java.nio.file.Path;
import java.util.ArrayList;
import java.util.Arrays;
import java.util.List;
import java.util.stream.Collectors;
import java.util.zip.ZipFile;
import org.junit.jupiter.api.Test;
import org.junit.jupiter.api.io.TempDir;
import proguard.Configuration;
import proguard.ConfigurationParser;
import proguard.ProGuard;

/** The app shrunk and its names taken away, by ProGuard with the AAR's rules and the coroutines' own. */
class ShrunkTest {
    @Test
    void aShrunkAppPrintsTheSame(@TempDir Path folder) throws Exception {
        List<String> parts = Arrays.stream(System.getProperty("java.class.path").split(File.pathSeparator))
            .filter(part -> part.matches(".*/(classes|(magcomp-host|kotlin-stdlib|kotlinx-coroutines-core-jvm|jna|annotations)-[0-9.]+\\.jar)/?"))
            .collect(Collectors.toList());
        assertEquals(6, parts.size(), parts.toString());
        Path coroutines = folder.resolve("coroutines.pro");
        try (ZipFile jar = new ZipFile(parts.stream().filter(part -> part.contains("coroutines")).findFirst().get())) {
            Files.copy(jar.getInputStream(jar.getEntry("META-INF/proguard/coroutines.pro")), coroutines);
        }
        Path shrunk = folder.resolve("shrunk.jar");
        List<String> arguments = new ArrayList<>();
        for (String part : parts) arguments.addAll(List.of("-injars", part + "(!META-INF/MANIFEST.MF,!META-INF/versions/**,!module-info.class)"));
        arguments.addAll(List.of("-outjars", shrunk.toString(), "-include", System.getProperty("rules"), "-include", coroutines.toString()));
        for (String module : List.of("java.base", "java.logging", "java.desktop")) {
            arguments.addAll(List.of("-libraryjars", System.getProperty("java.home") + "/jmods/" + module + ".jmod(!**.jar;!module-info.class)"));
        }
        // Android's classes are not here, nor R, which Android's tools make; an app's own entry point
        String missing = "android.**,org.json.**,org.magcomp.R,org.magcomp.R$string,kotlinx.coroutines.**,kotlin.**,java.lang.instrument.**,sun.**";
        arguments.addAll(List.of("-dontoptimize", "-dontwarn", missing, "-dontnote", "**"));
        arguments.addAll(List.of("-keep", "class app.Main { public static void main(java.lang.String[]); }"));
        Configuration configuration = new Configuration();
        try (ConfigurationParser parser = new ConfigurationParser(arguments.toArray(new String[0]), System.getProperties())) {
            parser.parse(configuration);
        }
        new ProGuard(configuration).execute();

        try (ZipFile jar = new ZipFile(shrunk.toFile())) {
            assertEquals(null, jar.getEntry("org/magcomp/Compass.class"), "its name was taken away");
            assertEquals(null, jar.getEntry("org/magcomp/core/ConstantField.class"));
        }
        String whole = printed(String.join(File.pathSeparator, parts));
        assertTrue(whole.contains("null true") && whole.contains("range_ut"), whole);
        // records print the names of their classes, which a shrunk app does not have
        assertEquals(withoutNames(whole), withoutNames(printed(shrunk.toString())));
    }

    private static String withoutNames(String printed) {
        return printed.replaceAll("[A-Za-z$.]+\\(", "(").replaceAll("[A-Za-z$.]+@[0-9a-f]+", "");
    }

    private static String printed(String classPath) throws Exception {
        String java = System.getProperty("java.home") + "/bin/java";
        Process process = new ProcessBuilder(java, "-cp", classPath, "app.Main").redirectErrorStream(true).start();
        String text = new String(process.getInputStream().readAllBytes());
        assertEquals(0, process.waitFor(), text);
        return text;
    }
}
