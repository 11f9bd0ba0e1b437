package app;

import static org.junit.jupiter.api.Assertions.assertEquals;
import static org.junit.jupiter.api.Assertions.assertNotNull;
import static org.junit.jupiter.api.Assertions.assertNull;
import static org.junit.jupiter.api.Assertions.assertTrue;

import java.io.StringReader;
import java.util.concurrent.CompletableFuture;
import java.util.concurrent.TimeUnit;
import org.junit.jupiter.api.Test;
import org.magcomp.Compass;
import org.magcomp.CompassReadingListener;
import org.magcomp.CompensatedReading;
import org.magcomp.RecordingSource;
import org.magcomp.core.Compensator;
import org.magcomp.core.DeviceVector;
import org.magcomp.core.ReadingBuffer;

/** The real core, over JNI and over JNA, with no setting of the JVM. */
class CoreTest {
    @Test
    void bothWaysReachOneLibrary() throws Exception {
        assertNull(System.getProperty("jna.library.path"));
        try (Compensator compensator = new Compensator()) {
            ReadingBuffer reading = new ReadingBuffer();
            for (int k = 1; k <= 1000; k++) {
                double[] raw = raw(k);
                // over JNI
                compensator.push(k * 10_000_000L, raw[0], raw[1], raw[2], reading);
            }
            // over JNA, of the same object
            DeviceVector hardIronUt = compensator.calibration().getHardIronUt();
            assertEquals(30, hardIronUt.getX(), 1);
            assertEquals(-20, hardIronUt.getY(), 1);
            assertEquals(40, hardIronUt.getZ(), 1);
            assertEquals(50, reading.getTotalFieldUt(), 2);
        }
    }

    @Test
    void aCompassPlaysARecording() throws Exception {
        StringBuilder csv = new StringBuilder("t_s,mx,my,mz\n");
        for (int k = 1; k <= 1000; k++) {
            double[] raw = raw(k);
            csv.append(k / 100.0).append(',').append(raw[0]).append(',').append(raw[1]).append(',').append(raw[2]).append('\n');
        }
        CompletableFuture<Exception> end = new CompletableFuture<>();
        CompletableFuture<CompensatedReading> calibrated = new CompletableFuture<>();
        new Compass(new RecordingSource("made", () -> new StringReader(csv.toString()))).start(Runnable::run, new CompassReadingListener() {
            @Override
            public void onReading(CompensatedReading reading) {
                if (reading.getReading().getFieldUt() != null) calibrated.complete(reading);
            }

            @Override
            public void onEnd(Exception error) {
                end.complete(error);
            }
        });
        assertNull(end.get(60, TimeUnit.SECONDS));
        assertNotNull(calibrated.get(1, TimeUnit.SECONDS));
        assertTrue(calibrated.get().getReading().getStatus().text().length() > 0);
    }

    /** A phone turned about in 50 uT, with a hard iron of (30, -20, 40) uT. */
    private static double[] raw(int k) {
        double a = k * 0.11;
        double b = k * 0.031;
        return new double[] {
            50 * Math.cos(a) * Math.cos(b) + 30 + 0.3 * Math.sin(k * 7.7),
            50 * Math.sin(a) * Math.cos(b) - 20 + 0.3 * Math.sin(k * 9.1),
            50 * Math.sin(b) + 40 + 0.3 * Math.sin(k * 5.3),
        };
    }
}
