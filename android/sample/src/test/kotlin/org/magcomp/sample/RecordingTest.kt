package org.magcomp.sample

import java.io.File
import kotlinx.coroutines.CompletableDeferred
import kotlinx.coroutines.awaitCancellation
import kotlinx.coroutines.flow.count
import kotlinx.coroutines.flow.first
import kotlinx.coroutines.runBlocking
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.junit.jupiter.api.io.TempDir
import org.magcomp.Compass
import org.magcomp.EventTaker
import org.magcomp.MagneticFieldSource
import org.magcomp.RawEvent
import org.magcomp.RecordingSource
import org.magcomp.samples
import org.magcomp.core.DeviceVector
import org.magcomp.core.MagneticSample
import org.magcomp.core.SensorSample

class RecordingTest {
    @TempDir
    lateinit var folder: File

    private val emitted = CompletableDeferred<Unit>()

    private val compass = Compass(object : MagneticFieldSource {
        override suspend fun deliver(taker: EventTaker) {
            for (k in 1L..100) taker.take(RawEvent().set(SensorSample.Magnetic(MagneticSample(k * 10_000_000, DeviceVector(1.0, 2.0, 3.0)))))
            emitted.complete(Unit)
            awaitCancellation()
        }
    })

    @Test
    fun `it records until it is told to stop, and says where`(): Unit = runBlocking {
        val recording = Recording(compass, folder, this, resources)
        assertEquals(RecordingState(false, "record the raw events to a file"), recording.state.value)
        recording.set(true)
        val file = recording.state.value.text.removePrefix("recording to ")
        assertTrue(recording.state.value.isOn && file.endsWith(".csv.gz") && File(file).parentFile == folder, file)
        emitted.await()
        recording.set(false)
        val ended = recording.state.first { !it.isOn }
        assertEquals(Pair("recorded to $file", File(file)), Pair(ended.text, ended.file))
        assertEquals(100, RecordingSource(File(file)).samples().count())
    }

    @Test
    fun `what it can't write it says`(): Unit = runBlocking {
        val recording = Recording(compass, folder.resolve("none"), this, resources)
        recording.set(true)
        val (_, text, file) = recording.state.first { !it.isOn }
        assertEquals(null, file, "there is nothing to share")
        assertTrue(text.startsWith("not recorded: ") && "none" in text, text)
    }
}
