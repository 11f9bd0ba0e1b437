package org.magcomp

import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertThrows
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

/** Handles: closed, panicked, invented; and JNI as it wants to be used. */
class HandleTest {
    private val values = tumbling(600)

    @Test
    fun `after close every use is a typed error`() {
        val compensator = Compensator()
        compensator.close()
        compensator.close()
        val out = ReadingBuffer()
        val uses = listOf(
            { compensator.push(1, 1.0, 2.0, 3.0, out) },
            { compensator.pushUp(1, 1.0, 2.0, 3.0) },
            { compensator.pushRotationRate(1, 1.0, 2.0, 3.0) },
            { compensator.pushAll(events(values)) },
            { compensator.calibration() },
            { compensator.keep(NOW_S) },
            { compensator.coverage() },
            { compensator.reset() },
            { compensator.adoptKept("", NOW_S) },
            { compensator.pushGap(1.0) },
            { compensator.gaps() },
        )
        for (use in uses) assertThrows(MagcompException.Closed::class.java) { use() }
    }

    @Test
    fun `every call after a panic says so, until reset`() {
        Compensator().use { compensator ->
            TestHooks.panicOnPurpose(compensator.handle)
            val calls = listOf(
                { compensator.push(1, 1.0, 2.0, 3.0, ReadingBuffer()) },
                { compensator.push(MagneticSample(1, DeviceVector(1.0, 2.0, 3.0))) },
                { compensator.pushUp(1, 0.0, 0.0, 9.8) },
                { compensator.pushRotationRate(1, 0.0, 0.0, 0.0) },
                { compensator.pushAll(events(values)) },
                { compensator.calibration() },
                { compensator.keep(NOW_S) },
                { compensator.coverage() },
            )
            for (call in calls) assertEquals("on purpose", assertThrows(MagcompException.Panicked::class.java) { call() }.what)
            compensator.reset()
            for (call in calls) call()
        }
    }

    @Test
    fun `JNI is used as it wants to be`() {
        val properties = listOf("java.library.path", "jna.library.path", "repository.root").map { "-D$it=" + System.getProperty(it) }
        val said = inProcessOfItsOwn("org.magcomp.CheckedMain", options = properties + "-Xcheck:jni").lines()
        assertTrue("checked: -Xcheck:jni" in said, "$said")
        // JNA's own library has some of its own
        val complaints = said.zipWithNext().filter { (line, frame) -> Regex("WARNING|FATAL").containsMatchIn(line) }
            .filter { (_, frame) -> "FastPath" in frame || "TestHooks" in frame }
        assertEquals(emptyList<Any>(), complaints)
    }

    @Test
    fun `a panic is a typed error until reset`() {
        val native = NativeCompensator(CompensationConfig())
        val handle = native.fastHandle()
        assertEquals(FastPath.PANICKED, TestHooks.panicOnPurpose(handle))
        val out = DoubleArray(FastPath.slots)
        assertEquals(FastPath.PANICKED, FastPath.pushUp(handle, 1, 0.0, 0.0, 9.8))
        assertEquals(FastPath.PANICKED, FastPath.push(handle, 1, 1.0, 2.0, 3.0, 0.0, 0.0, 0.0, out))
        val error = assertThrows(MagcompException.Panicked::class.java) { native.calibration() }
        assertEquals("on purpose", error.what)
        native.reset()
        assertEquals(0, FastPath.pushUp(handle, 1, 0.0, 0.0, 9.8))
        native.shutDown()
        assertEquals(FastPath.CLOSED, FastPath.pushUp(handle, 2, 0.0, 0.0, 9.8))
        assertThrows(MagcompException.Closed::class.java) { native.calibration() }
        native.close()
        assertEquals(FastPath.CLOSED, FastPath.pushUp(handle, 2, 0.0, 0.0, 9.8))
    }

    @Test
    fun `invented handles and short arrays do no harm`() {
        val out = DoubleArray(FastPath.slots)
        for (handle in listOf(0L, -1L, Long.MAX_VALUE, Long.MIN_VALUE, 1L shl 32 or 0xffff)) {
            assertEquals(FastPath.CLOSED, FastPath.push(handle, 1, 1.0, 2.0, 3.0, 0.0, 0.0, 0.0, out))
        }
        NativeCompensator(CompensationConfig()).use { native ->
            val handle = native.fastHandle()
            val short = DoubleArray(out.size - 1)
            assertThrows(IndexOutOfBoundsException::class.java) { FastPath.push(handle, 1, 1.0, 2.0, 3.0, 0.0, 0.0, 0.0, short) }
        }
    }

    @Test
    fun `what the fast path tells of a compensator is what uniffi tells`() {
        Compensator().use { nothing ->
            assertEquals(null, nothing.calibration())
            assertEquals(48, nothing.coverage().unseenDirections.size)
        }
        NativeCompensator(CompensationConfig()).use { native ->
            val (handle, out) = Pair(native.fastHandle(), DoubleArray(FastPath.slots))
            for (event in events(values)) {
                when (event) {
                    is SensorSample.Magnetic -> with(event.sample.fieldUt) { FastPath.push(handle, event.timeNs, x, y, z, 0.0, 0.0, 0.0, out) }
                    is SensorSample.Up -> with(event.sample.upMS2) { FastPath.pushUp(handle, event.timeNs, x, y, z) }
                    is SensorSample.RotationRate -> error("none is played")
                }
            }
            Compensator().use { compensator ->
                for (event in events(values)) {
                    when (event) {
                        is SensorSample.Magnetic -> with(event.sample) { compensator.push(copy(reportedHardIronUt = DeviceVector(0.0, 0.0, 0.0))) }
                        is SensorSample.Up -> with(event.sample.upMS2) { compensator.pushUp(event.timeNs, x, y, z) }
                        is SensorSample.RotationRate -> error("none is played")
                    }
                }
                assertEquals(native.coverage(), compensator.coverage())
                assertTrue(compensator.coverage().unseenDirections.size in 1..47, "${compensator.coverage()}")
                assertEquals(native.calibration()!!, compensator.calibration())
            }
            assertThrows(IndexOutOfBoundsException::class.java) { FastPath.calibration(handle, DoubleArray(9)) }
            assertThrows(IndexOutOfBoundsException::class.java) { FastPath.coverage(handle, DoubleArray(1)) }
        }
        for (call in listOf(FastPath.calibration(-1, DoubleArray(10)), FastPath.coverage(-1, DoubleArray(145)))) assertEquals(FastPath.CLOSED, call)
    }

    @Test
    fun `a handle is never given twice`() {
        val handles = (1..1000).map { NativeCompensator(CompensationConfig()).use { native -> native.fastHandle() } }
        assertEquals(1000, handles.toSet().size)
    }
}
