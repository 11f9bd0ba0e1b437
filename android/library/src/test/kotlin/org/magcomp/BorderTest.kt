package org.magcomp

import java.io.File
import org.junit.jupiter.api.Assertions.assertArrayEquals
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertFalse
import org.junit.jupiter.api.Assertions.assertNotEquals
import org.junit.jupiter.api.Assertions.assertNotNull
import org.junit.jupiter.api.Assertions.assertNull
import org.junit.jupiter.api.Assertions.assertThrows
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test

class BorderTest {
    private val values = tumbling(600)

    @Test
    fun `finds the hard iron, and says why not before`() {
        Compensator().use { compensator ->
            val readings = compensator.pushAll(events(values))
            assertTrue(readings.first().status is Status.Collecting)
            assertNull(readings.first().fieldUt)
            assertEquals(Status.Tracking, readings.last().status)
            assertEquals(50.0, readings.last().totalFieldUt!!, 2.0)
            val hardIron = compensator.calibration()!!.hardIronUt
            assertArrayEquals(HARD_IRON, doubleArrayOf(hardIron.x, hardIron.y, hardIron.z), 1.0)
            assertEquals(81, compensator.covariance()!!.size)
            assertNull(compensator.fit())
            assertTrue(compensator.coverage().share > 0.5)
        }
        Compensator(Config(method = Method.WINDOWED)).use { compensator ->
            compensator.pushAll(events(values))
            assertEquals(81, compensator.fit()!!.covariance.size)
        }
    }

    @Test
    fun `a whole reading of the magnetometer alone is the same over JNI and uniffi`() {
        val native = NativeCompensator(Config())
        Compensator().use { compensator ->
            val alone = events(values).filterIsInstance<SensorSample.Magnetic>()
            val over = compensator.pushAll(alone)
            val direct = alone.map { native.push(it.sample) }
            assertEquals(direct, over)
            assertTrue(over.any { it.modelOrder != null && it.directionSigmaDeg != null && it.worstSigmaDeg != null })
        }
        native.close()
    }

    @Test
    fun `a buffer shows every field of a reading`() {
        Compensator().use { compensator ->
            val buffer = ReadingBuffer()
            for (event in events(values)) {
                if (event is SensorSample.Magnetic) {
                    with(event.sample) { compensator.push(timeNs, fieldUt.x, fieldUt.y, fieldUt.z, buffer) }
                } else {
                    compensator.pushAll(listOf(event))
                }
            }
            val shown = with(buffer) {
                Reading(
                    timeNs, Vector3(xUt, yUt, zUt), fieldSigmaUt, Vector3(filteredXUt, filteredYUt, filteredZUt), totalFieldUt,
                    Heading(headingDeg, headingSigmaDeg, trueHeadingDeg, inclinationDeg),
                    Attitude(attitudeW, attitudeX, attitudeY, attitudeZ, attitudeSigmaDeg), sigmaT, window, coverage,
                    directionSigmaDeg, worstSigmaDeg, modelOrder, reportedHardIronJumpUt, mode, event, status,
                )
            }
            val unknown = Vector3(Double.NaN, Double.NaN, Double.NaN)
            val reading = buffer.toReading()
            val spelled = reading.copy(
                filteredFieldUt = reading.filteredFieldUt ?: unknown,
                heading = with(reading.heading!!) { copy(trueHeadingDeg = trueHeadingDeg ?: Double.NaN) },
                reportedHardIronJumpUt = Double.NaN,
                sigmaT = reading.sigmaT ?: Double.NaN,
                directionSigmaDeg = reading.directionSigmaDeg ?: Double.NaN,
                worstSigmaDeg = reading.worstSigmaDeg ?: Double.NaN,
            )
            assertEquals(spelled, shown)
            assertNotNull(reading.attitude!!.sigmaDeg)
        }
    }

    @Test
    fun `every status is read from JNI as uniffi has it`() {
        val problems = listOf(
            FitProblem.TooFewSamples(8),
            FitProblem.Planar(0.5),
            FitProblem.PoorCoverage(12.5, 10.0),
            FitProblem.Inconsistent(7.5, 2.5),
            FitProblem.NotAnEllipsoid,
            FitProblem.FieldOutOfRange(90.0, 22.0, 67.0),
            FitProblem.NotFinite,
        )
        val held = listOf(
            HoldReason.LowUniformity,
            HoldReason.FitRefused(problems[2]),
            HoldReason.Constant,
            HoldReason.AtRest,
            HoldReason.TooLittleRotation,
            HoldReason.NoGyroscope,
        )
        val rejected = listOf(
            RejectReason.NotFinite,
            RejectReason.OutOfRange(-2500.0, 2000.0),
            RejectReason.Saturated(Axis.Z, 1300.0, 1299.5),
            RejectReason.TimeNotAfter(7, 9_007_199_254_740_993),
            RejectReason.TimeJump(1e6, 604_800.0),
            RejectReason.Stuck(50),
        )
        val missing = listOf(Missing.Samples(60, 100), Missing.Rotation, Missing.Directions)
        val expected = listOf(Status.Tracking, Status.Suspect(-9_007_199_254_740_993)) +
            missing.map { Status.Collecting(it) } +
            problems.map { Status.Collecting(Missing.Fit(it)) } +
            held.map { Status.Held(it) } +
            Status.Disturbed(Long.MIN_VALUE + 1) +
            rejected.map { Status.Rejected(it) }
        val slots = DoubleArray(FastPath.slots())
        assertEquals(expected.size, TestHooks.exampleStatus(-1, slots))
        for ((index, status) in expected.withIndex()) {
            TestHooks.exampleStatus(index, slots)
            assertEquals(status, ReadingBuffer.status(slots))
            assertTrue(status.text().startsWith(status.label()), status.text())
        }
    }

    @Test
    fun `a config out of range is a typed error`() {
        val error = assertThrows(MagcompException.Config::class.java) {
            Compensator(Config(windowed = WindowedConfig(nMin = 3)))
        }
        assertEquals("windowed.n_min", error.field)
        assertTrue("at least 9" in error.text(), error.text())
    }

    @Test
    fun `the defaults are the core's`() {
        Compensator().use { plain ->
            Compensator(defaultConfig()).use { spelled ->
                assertEquals(plain.pushAll(events(values)), spelled.pushAll(events(values)))
                assertEquals(plain.keep(NOW_S), spelled.keep(NOW_S))
            }
        }
    }

    @Test
    fun `a bad sample is rejected and changes nothing`() {
        Compensator().use { compensator ->
            compensator.pushAll(events(values))
            val before = compensator.keep(NOW_S)!!
            val out = ReadingBuffer()
            compensator.push(Long.MAX_VALUE, Double.NaN, 0.0, 0.0, out)
            assertEquals(Status.Rejected(RejectReason.NotFinite), out.status)
            compensator.push(5, 1.0, 2.0, 3.0, out)
            assertEquals(Status.Rejected(RejectReason.TimeNotAfter(5, 600 * STEP_NS)), out.status)
            assertFalse(compensator.pushUp(5, 0.0, 0.0, 9.8), "too late")
            assertFalse(compensator.pushRotationRate(5, Double.NaN, 0.0, 0.0))
            assertEquals(before, compensator.keep(NOW_S))
        }
    }

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
                { compensator.push(MagneticSample(1, Vector3(1.0, 2.0, 3.0))) },
                { compensator.pushUp(1, 0.0, 0.0, 9.8) },
                { compensator.pushRotationRate(1, 0.0, 0.0, 0.0) },
                { compensator.pushAll(events(values)) },
                { compensator.calibration() },
                { compensator.keep(NOW_S) },
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
        val native = NativeCompensator(Config())
        val handle = native.fastHandle()
        assertEquals(FastPath.PANICKED, TestHooks.panicOnPurpose(handle))
        val out = DoubleArray(FastPath.slots())
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
        val out = DoubleArray(FastPath.slots())
        for (handle in listOf(0L, -1L, Long.MAX_VALUE, Long.MIN_VALUE, 1L shl 32 or 0xffff)) {
            assertEquals(FastPath.CLOSED, FastPath.push(handle, 1, 1.0, 2.0, 3.0, 0.0, 0.0, 0.0, out))
        }
        NativeCompensator(Config()).use { native ->
            val handle = native.fastHandle()
            val short = DoubleArray(out.size - 1)
            assertThrows(IndexOutOfBoundsException::class.java) { FastPath.push(handle, 1, 1.0, 2.0, 3.0, 0.0, 0.0, 0.0, short) }
            assertEquals(FastPath.TOO_SHORT, FastPath.pushBatch(handle, ByteArray(2), LongArray(1), DoubleArray(6), out))
            assertEquals(FastPath.TOO_SHORT, FastPath.pushBatch(handle, ByteArray(2), longArrayOf(1, 2), DoubleArray(6), out))
            assertEquals(FastPath.NO_SUCH_KIND, FastPath.pushBatch(handle, byteArrayOf(9), LongArray(1), DoubleArray(3), out))
        }
    }

    @Test
    fun `a handle is never given twice`() {
        val handles = (1..1000).map { NativeCompensator(Config()).use { native -> native.fastHandle() } }
        assertEquals(1000, handles.toSet().size)
    }

    @Test
    fun `a kept calibration is in force again, less sure with its age, in a stream that goes on`() {
        val all = events(values)
        Compensator().use { first ->
            assertNull(first.keep(NOW_S), "nothing was learned")
            first.pushAll(all)
            val text = first.keep(NOW_S)!!
            val sigmas = listOf(60L, 3600L, 86_400L, null).map { age ->
                Compensator().use { second ->
                    second.setHeadingFrame(HeadingFrame(ReferenceAxis.TOP_EDGE, ScreenRotation.DEG90, 3.0))
                    second.push(MagneticSample(STEP_NS, Vector3(1.0, 2.0, 3.0)))
                    second.adoptKept(text, age?.let { NOW_S + it })
                    assertEquals(first.calibration()!!.hardIronUt, second.calibration()!!.hardIronUt)
                    assertNull(second.keep(NOW_S), "nothing was learned since")
                    val rejected = second.push(MagneticSample(STEP_NS, Vector3(1.0, 2.0, 3.0)))
                    assertTrue((rejected.status as Status.Rejected).reason is RejectReason.TimeNotAfter, "the clock goes on")
                    second.pushAll(flat(10)).single().let { reading ->
                        assertTrue(reading.heading?.let { it.trueHeadingDeg != null } ?: true, "the frame stays")
                        assertNotEquals(Status.Tracking, reading.status)
                        reading.fieldSigmaUt ?: 1e9
                    }
                }
            }
            assertEquals(sigmas.sorted(), sigmas, "$sigmas")
            assertTrue(sigmas.first() < 10.0 && sigmas.last() > 2 * sigmas.first(), "$sigmas")
        }
    }

    @Test
    fun `a text that is damaged or newer is a typed error and changes nothing`() {
        Compensator().use { compensator ->
            compensator.pushAll(events(values))
            val text = compensator.keep(NOW_S)!!
            for (damaged in listOf("", "{}", "nonsense", text.dropLast(9), text.replaceFirst("\"learned\"", "\"luck\""))) {
                val error = assertThrows(MagcompException.KeptDamaged::class.java) { compensator.adoptKept(damaged, NOW_S) }
                assertTrue(error.why.isNotEmpty() && error.why in error.text(), error.text())
            }
            val error = assertThrows(MagcompException.KeptNewer::class.java) { compensator.adoptKept(newer(text), NOW_S) }
            assertEquals(99, error.found)
            assertEquals(text, compensator.keep(NOW_S))
        }
    }

    @Test
    fun `time that the clock does not show makes the calibration less sure`() {
        val gone = listOf(0.0, 8 * 3600.0).map { hiddenS ->
            Compensator().use { compensator ->
                compensator.pushAll(events(values))
                val gaps = compensator.gaps()
                compensator.pushGap(hiddenS)
                assertEquals(gaps + 1, compensator.gaps())
                compensator.pushAll(flat(values.size / 3)).single().fieldSigmaUt ?: 1e9
            }
        }
        assertTrue(gone[1] > 1.2 * gone[0], "$gone")
        Compensator().use {
            val error = assertThrows(MagcompException.Config::class.java) { it.pushGap(-1.0) }
            assertEquals("hidden_s", error.field)
            assertEquals(0, it.gaps())
        }
    }

    @Test
    fun `a saturated sample names its axis`() {
        Compensator(Config(railUt = 1200.0)).use { compensator ->
            val at = listOf(Vector3(1200.0, 1.0, 2.0), Vector3(1.0, -1201.0, 2.0), Vector3(1.0, 2.0, 1300.0))
            val reasons = at.mapIndexed { k, field -> (compensator.push(MagneticSample(k + 1L, field)).status as Status.Rejected).reason }
            val expected = listOf(Pair(Axis.X, 1200.0), Pair(Axis.Y, -1201.0), Pair(Axis.Z, 1300.0))
            assertEquals(expected.map { (axis, value) -> RejectReason.Saturated(axis, value, 1200.0) }, reasons)
            assertTrue(" y -1201.0 uT" in reasons[1].text(), reasons[1].text())
        }
    }

    @Test
    fun `the operating system's hard iron gives readings from the first sample on`() {
        val first = MagneticSample(STEP_NS, Vector3(120.0, -35.0, 300.0), Vector3(120.0, -80.0, 300.0))
        Compensator().use { compensator ->
            val reading = compensator.push(first)
            assertEquals(Vector3(0.0, 45.0, 0.0), reading.fieldUt)
            assertNull(reading.reportedHardIronJumpUt)
        }
        Compensator(Config(useReportedHardIron = false)).use { assertNull(it.push(first).fieldUt) }
    }

    @Test
    fun `an adopted calibration is as unsure as it is said to be`() {
        val first = MagneticSample(STEP_NS, Vector3(120.0, -35.0, 300.0))
        val calibration = Calibration(SoftIron(1.0, 1.0, 1.0, 0.0, 0.0, 0.0), Vector3(120.0, -80.0, 300.0), 45.0)
        val sigmas = listOf(3.0, 30.0).map { sigmaUt ->
            Compensator().use {
                it.adopt(calibration, sigmaUt)
                it.push(first).fieldSigmaUt!!
            }
        }
        // the sample's own strength tells one of three axes
        assertTrue(sigmas[0] in 3.0..6.0 && sigmas[1] in 20.0..60.0, "$sigmas")
        Compensator().use {
            val error = assertThrows(MagcompException.Config::class.java) { it.adopt(calibration, 0.0) }
            assertEquals("hard_iron_sigma_ut", error.field)
            assertNull(it.calibration())
        }
    }

    @Test
    fun `a jump of the operating system's hard iron is visible`() {
        Compensator().use { compensator ->
            val b = listOf(Vector3(1.0, 2.0, 3.0), Vector3(1.0, 2.0, 3.0), Vector3(4.0, 2.0, -1.0), null, Vector3(4.0, 2.0, -1.0))
            val jumps = b.mapIndexed { k, reported ->
                compensator.push(MagneticSample(k + 1L, Vector3(1.0 * k, 0.0, 0.0), reported)).reportedHardIronJumpUt
            }
            assertEquals(listOf(null, null, 5.0, null, null), jumps)
        }
    }

    @Test
    fun `a heading frame may change in the stream`() {
        val landscape = HeadingFrame(ReferenceAxis.TOP_EDGE, ScreenRotation.DEG90, 10.0)
        Compensator().use { compensator ->
            compensator.pushAll(events(values))
            compensator.setHeadingFrame(landscape)
            // after a pause: the vertical is that of the sample
            val reading = compensator.pushAll(events(tumbling(1, seed = 2), 600 * STEP_NS + PAUSE_NS)).single()
            val expected = heading(reading.fieldUt!!, up(0), landscape)!!
            assertEquals(expected.headingDeg, reading.heading!!.headingDeg)
            assertEquals(expected.trueHeadingDeg, reading.heading!!.trueHeadingDeg)
            assertNotNull(reading.heading!!.headingSigmaDeg)
            assertThrows(MagcompException.Config::class.java) { compensator.setHeadingFrame(landscape.copy(declinationDeg = 200.0)) }
        }
    }

    @Test
    fun `a constant calibration guides to the directions that are missing`() {
        ConstantField().use { session ->
            assertThrows(MagcompException.Fit::class.java) { session.finish() }
            for (k in 0 until 40) session.add(Vector3(values[3 * k], values[3 * k + 1], values[3 * k + 2]))
            val before = session.coverage()
            for (k in 40 until 600) session.add(Vector3(values[3 * k], values[3 * k + 1], values[3 * k + 2]))
            val after = session.coverage()
            assertTrue(after.unseenDirections.size < before.unseenDirections.size)
            assertEquals(600, session.orientations())
            val fit = session.finish()
            assertEquals(120.0, fit.calibration.hardIronUt.x, 1.0)
            val corrected = correct(fit.calibration, Vector3(values[0], values[1], values[2]))
            assertNotEquals(values[0], corrected.x)
            assertThrows(MagcompException.Rejected::class.java) { session.add(Vector3(Double.NaN, 0.0, 0.0)) }
            session.reset()
            assertEquals(0, session.orientations())
        }
    }

    @Test
    fun `a constant calibration that was closed says so`() {
        val session = ConstantField(samplesPerOrientation = 5)
        session.close()
        session.close()
        val uses = listOf(
            { session.add(Vector3(1.0, 2.0, 3.0)) },
            { session.orientations() },
            { session.coverage() },
            { session.finish() },
            { session.reset() },
        )
        for (use in uses) assertThrows(MagcompException.Closed::class.java) { use() }
    }

    @Test
    fun `messages go to stderr under their tag, as many as their level lets through`() {
        fun said(level: LogLevel): String {
            // in a process of its own: the log of this one is set once
            val java = File(System.getProperty("java.home"), "bin/java").path
            val options = listOf("java.library.path", "jna.library.path").map { "-D$it=" + System.getProperty(it) }
            val command = listOf(java) + options + listOf("-cp", System.getProperty("java.class.path"), "org.magcomp.LoggingMain", level.name)
            val process = ProcessBuilder(command).redirectOutput(ProcessBuilder.Redirect.DISCARD).start()
            val text = process.errorStream.reader().readText()
            assertEquals(0, process.waitFor(), text)
            return text
        }
        val errors = said(LogLevel.ERROR)
        assertTrue(Regex("^ERROR compass-app: panicked at .*", RegexOption.MULTILINE).containsMatchIn(errors), errors)
        assertTrue("ERROR compass-app: panic caught at the border: on purpose" in errors, errors)
        assertFalse("WARN" in errors, errors)
        val warnings = said(LogLevel.WARN)
        assertTrue("WARN compass-app: the operating system's hard iron was not taken over" in warnings, warnings)
        assertFalse("compass-app" in said(LogLevel.OFF))
    }

    @Test
    fun `an event out of order, late or missing leaves the pairing of the others alone`() {
        val flat = Vector3(0.0, 0.0, 9.81)
        val field = { k: Int -> Vector3(values[3 * k], values[3 * k + 1], values[3 * k + 2]) }
        Compensator().use { compensator ->
            compensator.pushAll(events(values))
            val begin = 600 * STEP_NS + PAUSE_NS
            fun headingAfter(timeNs: Long, k: Int) = compensator.push(MagneticSample(timeNs, field(k))).heading
            compensator.pushUp(begin + 1_000_000, flat.x, flat.y, flat.z)
            val paired = headingAfter(begin + 2_000_000, 7)
            assertNotNull(paired)
            assertFalse(compensator.pushUp(begin + 500_000, 9.81, 0.0, 0.0), "older than a sample answered: not used")
            // the calibration goes on learning meanwhile
            assertEquals(paired!!.headingDeg, headingAfter(begin + 3_000_000, 7)!!.headingDeg, 0.01)
            assertNull(headingAfter(begin + 900_000_000, 7), "the latest up is too old")
        }
    }
}
