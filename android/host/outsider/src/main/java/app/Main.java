package app;

import java.io.StringReader;
import java.util.concurrent.CompletableFuture;
import org.magcomp.Compass;
import org.magcomp.CompassReadingListener;
import org.magcomp.CompensatedReading;
import org.magcomp.RecordingSource;
import org.magcomp.core.CompensationConfigBuilder;
import org.magcomp.core.Compensator;
import org.magcomp.core.MagcompException;
import org.magcomp.core.ReadingBuffer;

/** A small app: what it prints must not change when it is shrunk. */
public class Main {
    public static void main(String[] arguments) throws Exception {
        StringBuilder csv = new StringBuilder("t_s,mx,my,mz\n");
        try (Compensator compensator = new Compensator()) {
            ReadingBuffer reading = new ReadingBuffer();
            for (int k = 1; k <= 1000; k++) {
                double[] raw = raw(k);
                csv.append(k / 100.0).append(',').append(raw[0]).append(',').append(raw[1]).append(',').append(raw[2]).append('\n');
                // over JNI
                compensator.push(k * 10_000_000L, raw[0], raw[1], raw[2], reading);
            }
            // over JNA, of the same object
            System.out.println(compensator.calibration() + " " + reading.getTotalFieldUt());
            System.out.println(reading.toReading());
        }
        CompletableFuture<Exception> end = new CompletableFuture<>();
        int[] calibrated = new int[1];
        new Compass(new RecordingSource("made", () -> new StringReader(csv.toString()))).start(Runnable::run, new CompassReadingListener() {
            @Override
            public void onReading(CompensatedReading reading) {
                if (reading.getReading().getFieldUt() != null) calibrated[0] += 1;
            }

            @Override
            public void onEnd(Exception error) {
                end.complete(error);
            }
        });
        System.out.println(end.get() + " " + (calibrated[0] > 0));
        try (Compensator refused = new Compensator(new CompensationConfigBuilder().rangeUt(-1.0).build())) {
            System.out.println("accepted");
        } catch (MagcompException e) {
            System.out.println(e.text());
        }
        System.exit(0);
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
