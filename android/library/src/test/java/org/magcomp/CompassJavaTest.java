package org.magcomp;

import static org.junit.jupiter.api.Assertions.assertEquals;
import static org.junit.jupiter.api.Assertions.assertInstanceOf;
import static org.junit.jupiter.api.Assertions.assertNotNull;
import static org.junit.jupiter.api.Assertions.assertNull;
import static org.junit.jupiter.api.Assertions.assertTrue;
import static org.junit.jupiter.api.Assertions.fail;

import java.io.File;
import java.io.IOException;
import java.io.StringReader;
import java.util.concurrent.CompletableFuture;
import java.util.concurrent.CountDownLatch;
import java.util.concurrent.ExecutorService;
import java.util.concurrent.Executors;
import java.util.concurrent.TimeUnit;
import java.util.concurrent.atomic.AtomicInteger;
import org.junit.jupiter.api.AfterEach;
import org.junit.jupiter.api.Test;
import org.junit.jupiter.api.io.TempDir;
import org.magcomp.core.*;

/** What a Java developer writes. */
class CompassJavaTest {
    private final ExecutorService executor = Executors.newSingleThreadExecutor();

    @AfterEach
    void end() {
        executor.shutdownNow();
    }

    private static class Counter implements CompassReadingListener {
        final AtomicInteger readings = new AtomicInteger();
        final CompletableFuture<Exception> ended = new CompletableFuture<>();
        volatile CompensatedReading latest;

        @Override
        public void onReading(CompensatedReading reading) {
            latest = reading;
            readings.incrementAndGet();
        }

        @Override
        public void onEnd(Exception error) {
            ended.complete(error);
        }
    }

    @Test
    void aListenerGetsEveryReadingAndTheEnd() throws Exception {
        File file = new File(System.getProperty("repository.root"), "tests/recordings/broad_34_attached_magnet_3cm.csv.gz");
        Counter counter = new Counter();
        try (CompassHandle running = new Compass(new RecordingSource(file)).start(executor, counter)) {
            assertNull(counter.ended.get(60, TimeUnit.SECONDS));
            assertTrue(counter.readings.get() > 0);
            assertNotNull(counter.latest.getReading().getHeading());
        }
    }

    @Test
    void aListenerGetsTheError() throws Exception {
        Compass compass = new Compass(new RecordingSource("text", () -> new StringReader("t_s,mx\n")));
        Counter counter = new Counter();
        try (CompassHandle running = compass.start(executor, counter)) {
            Exception error = counter.ended.get(60, TimeUnit.SECONDS);
            assertEquals(1, assertInstanceOf(RecordingException.class, error).getLine());
        }
    }

    @Test
    void aListenerGetsTheErrorOfAFileThatIsNotThere() throws Exception {
        Counter counter = new Counter();
        try (CompassHandle running = new Compass(new RecordingSource(new File("no such.csv"))).start(executor, counter)) {
            assertInstanceOf(IOException.class, counter.ended.get(60, TimeUnit.SECONDS));
        }
    }

    @Test
    void errorsCanBeCaught() {
        // compiles because the class says what it throws
        try (Compensator compensator = new Compensator()) {
            compensator.adoptKept("nonsense", null);
            fail("adopted");
        } catch (MagcompException.KeptDamaged e) {
            assertTrue(e.text().contains("kept calibration"), e.text());
        } catch (MagcompException e) {
            fail(e);
        }
    }

    @Test
    void closingEndsTheReadings() throws Exception {
        // a recording without an end
        Compass compass = new Compass(new RecordingSource("endless", EndlessReader::new));
        CountDownLatch some = new CountDownLatch(100);
        AtomicInteger readings = new AtomicInteger();
        CompassHandle running = compass.start(executor, new CompassReadingListener() {
            @Override
            public void onReading(CompensatedReading reading) {
                readings.incrementAndGet();
                some.countDown();
            }

            @Override
            public void onEnd(Exception error) {
                readings.set(-1);
            }
        });
        assertTrue(some.await(60, TimeUnit.SECONDS));
        running.close();
        // what was under way is finished
        executor.submit(() -> { }).get(60, TimeUnit.SECONDS);
        int after = readings.get();
        executor.submit(() -> { }).get(60, TimeUnit.SECONDS);
        assertEquals(after, readings.get());
        assertTrue(after >= 100, "the end was not announced");
    }

    @Test
    void aScreenHasItsOwnRotationAndAxis() throws Exception {
        File file = new File(System.getProperty("repository.root"), "tests/recordings/broad_34_attached_magnet_3cm.csv.gz");
        double[] lastDeg = new double[2];
        for (int k = 0; k < 2; k++) {
            int at = k;
            ScreenRotation rotation = k == 0 ? ScreenRotation.DEG0 : ScreenRotation.DEG180;
            CompletableFuture<Exception> ended = new CompletableFuture<>();
            new Compass(new RecordingSource(file)).start(executor, new HeadingListener() {
                @Override
                public void onHeading(CompassReading reading) {
                    if (reading.getHeadingDeg() != null) lastDeg[at] = reading.getHeadingDeg();
                }

                @Override
                public void onEnd(Exception error) {
                    ended.complete(error);
                }
            }, ReferenceAxis.TOP_EDGE, () -> rotation);
            assertNull(ended.get(60, TimeUnit.SECONDS));
        }
        assertEquals(180, Math.abs(Math.IEEEremainder(lastDeg[1] - lastDeg[0], 360)), 1e-6);
    }

    @Test
    void aHandleIsClosedWithoutACatch() {
        Compass.create(new RecordingSource("endless", EndlessReader::new), new CompensationConfig(), null, 0).start(executor, new Counter()).close();
    }

    @Test
    void oneHeadingAndARecording(@TempDir File folder) throws Exception {
        File file = new File(System.getProperty("repository.root"), "tests/recordings/broad_34_attached_magnet_3cm.csv.gz");
        CompletableFuture<CompassReading> heading = new CompletableFuture<>();
        new Compass(new RecordingSource(file)).heading(60_000, 180, executor, (reading, error) -> heading.complete(reading));
        assertNotNull(heading.get(60, TimeUnit.SECONDS).getHeadingDeg());

        CompletableFuture<Exception> refused = new CompletableFuture<>();
        new Compass(new RecordingSource(file)).heading(0, 180, executor, (reading, error) -> refused.complete(error));
        assertInstanceOf(IllegalArgumentException.class, refused.get(60, TimeUnit.SECONDS));

        // closing ends the recording, and says when the file is whole
        File recorded = new File(folder, "r.csv.gz");
        CompletableFuture<Exception> ended = new CompletableFuture<>();
        CompassHandle recording = new Compass(new RecordingSource("endless", EndlessReader::new)).record(recorded, executor, (of, error) -> {
            assertEquals(recorded, of);
            ended.complete(error);
        });
        while (recorded.length() == 0) Thread.sleep(1);
        recording.close();
        assertNull(ended.get(60, TimeUnit.SECONDS));
        Counter counter = new Counter();
        new Compass(new RecordingSource(recorded)).start(executor, counter);
        assertNull(counter.ended.get(60, TimeUnit.SECONDS));
        assertTrue(counter.readings.get() > 0);

        CompletableFuture<Exception> there = new CompletableFuture<>();
        new Compass(new RecordingSource(file)).record(recorded, executor, (of, error) -> there.complete(error));
        assertInstanceOf(IOException.class, there.get(60, TimeUnit.SECONDS));
    }

    private static class EndlessReader extends java.io.Reader {
        private String text = "t_s,mx,my,mz\n";
        private int row;

        @Override
        public int read(char[] to, int from, int length) {
            if (text.isEmpty()) {
                row += 1;
                text = row * 0.01 + "," + row % 40 + "," + row % 37 + "," + row % 31 + "\n";
            }
            int n = Math.min(length, text.length());
            text.getChars(0, n, to, from);
            text = text.substring(n);
            return n;
        }

        @Override
        public void close() { }
    }
}
