package org.magcomp

import android.hardware.Sensor
import android.hardware.SensorEvent
import android.hardware.SensorEventListener
import android.hardware.SensorManager
import java.util.concurrent.CopyOnWriteArrayList
import java.util.concurrent.locks.LockSupport
import kotlin.concurrent.thread
import kotlin.time.Duration.Companion.ZERO
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.async
import kotlinx.coroutines.cancelAndJoin
import kotlinx.coroutines.delay
import kotlinx.coroutines.flow.first
import kotlinx.coroutines.flow.take
import kotlinx.coroutines.flow.toList
import kotlinx.coroutines.launch
import kotlinx.coroutines.runBlocking
import kotlinx.coroutines.withTimeout
import kotlinx.coroutines.yield
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertThrows
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

class SensorManagerSourceTest {
    private val all = intArrayOf(
        Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED,
        Sensor.TYPE_MAGNETIC_FIELD,
        Sensor.TYPE_GRAVITY,
        Sensor.TYPE_ACCELEROMETER,
        Sensor.TYPE_GYROSCOPE,
    )

    @Test
    fun `events arrive in order, copied, though Android uses the event again`() = runBlocking {
        val sensors = FakeSensorManager(*all)
        val samples = collectWhile(sensors, sensors.source(), 4) {
            sensors.deliver(Sensor.TYPE_GYROSCOPE, 1, 0.1f, 0.2f, 0.3f)
            sensors.deliver(Sensor.TYPE_GRAVITY, 2, 0f, 0f, 9.81f)
            sensors.deliver(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, 3, 120f, -35f, 300f, 120f, -80f, 300f)
            sensors.deliver(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, 4, 121f, -36f, 301f, 120f, -80f, 300f)
        }
        val reported = DeviceVector(120.0, -80.0, 300.0)
        assertEquals(
            listOf(
                SensorSample.RotationRate(RotationRateSample(1, DeviceVector(0.1f.toDouble(), 0.2f.toDouble(), 0.3f.toDouble()))),
                SensorSample.Up(UpSample(2, DeviceVector(0.0, 0.0, 9.81f.toDouble()))),
                SensorSample.Magnetic(MagneticSample(3, DeviceVector(120.0, -35.0, 300.0), reported)),
                SensorSample.Magnetic(MagneticSample(4, DeviceVector(121.0, -36.0, 301.0), reported)),
            ),
            samples,
        )
    }

    @Test
    fun `the best sensors are chosen, at the rate and latency asked for`() = runBlocking {
        val sensors = FakeSensorManager(*all)
        val options = SensorOptions(rateHz = 50, maxReportLatencyUs = 7, holdS = 0.0)
        collectWhile(sensors, sensors.source(options), 1) {
            assertEquals(
                listOf(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_GRAVITY, Sensor.TYPE_GYROSCOPE),
                sensors.registrations.map { it.sensor.type },
            )
            assertTrue(sensors.registrations.all { it.periodUs == 20_000 && it.latencyUs == 7 })
            sensors.deliver(Sensor.TYPE_GYROSCOPE, 1, 0f, 0f, 0f)
        }
        assertEquals(0, sensors.registrations.size, "unregistered")
        assertEquals(0, sensors.threads, "its thread has ended")
    }

    @Test
    fun `the magnetometer may have a rate of its own`() = runBlocking {
        val sensors = FakeSensorManager(*all)
        collectWhile(sensors, sensors.source(SensorOptions(rateHz = 200, magnetometerRateHz = 20, holdS = 0.0), permitted = false), 1) {
            assertEquals(listOf(50_000, 5000, 5000), sensors.registrations.map { it.periodUs })
            sensors.deliver(Sensor.TYPE_GYROSCOPE, 1, 0f, 0f, 0f)
        }
        val fast = SensorOptions(magnetometerRateHz = 201)
        assertThrows(SensorException.PermissionMissing::class.java) {
            runBlocking { withTimeout(120_000) { FakeSensorManager(*all).source(fast, permitted = false).samples().first() } }
        }
        for (rateHz in listOf(0, 1001)) assertThrows(IllegalArgumentException::class.java) { SensorOptions(magnetometerRateHz = rateHz) }
    }

    @Test
    fun `without the best sensors the next best are used`() = runBlocking {
        val sensors = FakeSensorManager(Sensor.TYPE_MAGNETIC_FIELD, Sensor.TYPE_ACCELEROMETER)
        val samples = collectWhile(sensors, sensors.source(), 2) {
            sensors.deliver(Sensor.TYPE_ACCELEROMETER, 1, 4f, -9f, 2f)
            sensors.deliver(Sensor.TYPE_MAGNETIC_FIELD, 2, 1f, 2f, 3f)
        }
        val expected = listOf(
            SensorSample.Up(UpSample(1, DeviceVector(4.0, -9.0, 2.0))),
            SensorSample.Magnetic(MagneticSample(2, DeviceVector(1.0, 2.0, 3.0), null)),
        )
        assertEquals(expected, samples)
    }

    @Test
    fun `what is missing or refused is a typed error that says which`() {
        fun fails(sensors: FakeSensorManager, options: SensorOptions = SensorOptions(), permitted: Boolean = true): SensorException {
            val error = assertThrows(SensorException::class.java) {
                runBlocking { withTimeout(120_000) { sensors.source(options, permitted).samples().first() } }
            }
            assertEquals(0, sensors.registrations.size, "nothing stays registered")
            assertEquals(0, sensors.threads, "no thread stays")
            return error
        }
        val none = fails(FakeSensorManager(Sensor.TYPE_GRAVITY)) as SensorException.Missing
        assertEquals("magnetometer", none.sensor)
        val noUp = fails(FakeSensorManager(Sensor.TYPE_MAGNETIC_FIELD)) as SensorException.Missing
        assertEquals("accelerometer", noUp.sensor)
        val fast = SensorOptions(rateHz = 201)
        val permission = fails(FakeSensorManager(*all), fast, permitted = false) as SensorException.PermissionMissing
        assertEquals("android.permission.HIGH_SAMPLING_RATE_SENSORS", permission.permission)
        assertTrue(fails(FakeSensorManager(*all).apply { forbid = true }, fast) is SensorException.PermissionMissing)
        // at a rate that needs none it was no missing permission
        val forbidden = fails(FakeSensorManager(*all).apply { forbid = true }) as SensorException.Refused
        assertEquals(Pair("magnetometer", "the permission is missing"), Pair(forbidden.sensor, forbidden.reason))
        assertTrue("let the app use" in forbidden.message!!, forbidden.message)
        val refused = fails(FakeSensorManager(*all).apply { refuse = Sensor.TYPE_GRAVITY }) as SensorException.Refused
        assertEquals("gravity sensor", refused.sensor)
    }

    @Test
    fun `a start that fails calls its taker no more`() {
        val sensors = FakeSensorManager(*all).apply { refuse = Sensor.TYPE_GRAVITY }
        val taken = ArrayList<Long>()
        val taker = object : EventTaker {
            override fun take(event: RawEvent) {
                taken += event.timeNs
            }
        }
        fun deliver() = sensors.deliver(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, 1 + taken.size.toLong(), 1f, 2f, 3f)
        var listener: SensorEventListener? = null
        sensors.unregistering = {
            listener = sensors.registrations.single().listener
            // what was on its way
            deliver()
        }
        assertThrows(SensorException.Refused::class.java) { runBlocking { sensors.source().deliver(taker) } }
        // an event that the thread had before it ended
        listener!!.onSensorChanged(SensorEvent(sensors.getDefaultSensor(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED)!!, 0, 9, floatArrayOf(1f, 2f, 3f)))
        assertEquals(emptyList<Long>(), taken)
    }

    @Test
    fun `up to 200 Hz no permission is needed`() = runBlocking {
        val sensors = FakeSensorManager(*all)
        val source = sensors.source(SensorOptions(rateHz = 200, holdS = 0.0), permitted = false)
        collectWhile(sensors, source, 1) {
            assertTrue(sensors.registrations.all { it.periodUs == 5000 })
            sensors.deliver(Sensor.TYPE_GYROSCOPE, 1, 0f, 0f, 0f)
        }
        assertEquals(0, sensors.registrations.size)
    }

    @Test
    fun `a listener too many is a typed error, and the others go on`(): Unit = runBlocking {
        val sensors = FakeSensorManager(*all)
        val others = List(FakeSensorManager.LISTENER_LIMIT - 1) { launch { sensors.source().samples().collect { } } }
        sensors.registered(3 * others.size)
        // the last that Android lets in gets its magnetometer, then no gravity
        val error = assertThrows(SensorException.Refused::class.java) { runBlocking { sensors.source().samples().first() } }
        assertEquals("gravity sensor", error.sensor)
        assertEquals(
            "the system refused to deliver the gravity sensor (register failed, the sensor listeners size has exceeded the " +
                "maximum limit 128); end other uses of the sensors and try again",
            error.message,
        )
        assertTrue(error.cause is IllegalStateException)
        assertEquals(3 * others.size, sensors.registrations.size, "nothing of its own stays registered")
        assertEquals(others.size, sensors.threads)
        // and as the message says
        others.first().cancelAndJoin()
        val again = launch { sensors.source().samples().collect { } }
        sensors.registered(3 * others.size)
        (others + again).forEach { it.cancelAndJoin() }
        assertEquals(0, sensors.registrations.size)
    }

    @Test
    fun `an error of the collector unregisters the sensors`() {
        class OfTheApp : Exception()
        val sensors = FakeSensorManager(*all)
        assertThrows(OfTheApp::class.java) {
            runBlocking {
                launch {
                    sensors.registered(3)
                    sensors.deliver(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, 1, 1f, 2f, 3f)
                }
                sensors.source().samples().compensated().collect { throw OfTheApp() }
            }
        }
        assertEquals(0, sensors.registrations.size)
        assertEquals(0, sensors.threads)
    }

    @Test
    fun `cancelled in the middle of events, again and again`() = runBlocking {
        val sensors = FakeSensorManager(*all)
        val source = sensors.source()
        var running = true
        val player = thread {
            var time = 1L
            while (running) {
                sensors.deliver(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, time++, 1f, 2f, (time % 97).toFloat(), 0f, 0f, 0f)
                LockSupport.parkNanos(10_000) // far above any sensor's rate
            }
        }
        repeat(200) {
            val readings = source.samples().compensated().take(1 + it % 3).toList()
            assertEquals(1 + it % 3, readings.size)
        }
        running = false
        player.join()
        assertEquals(0, sensors.registrations.size)
    }

    @Test
    fun `no event is dropped before the estimator, however slow its collector`() = runBlocking {
        val sensors = FakeSensorManager(*all)
        val samples = collectWhile(sensors, sensors.source(), 5000) {
            // all at once, before the collector runs again
            for (k in 1L..5000) sensors.deliver(Sensor.TYPE_GYROSCOPE, k, k.toFloat(), 0f, 0f)
        }
        assertEquals((1L..5000).toList(), samples.map { it.timeNs })
    }

    @Test
    fun `the hard iron is that of its event, whichever number changes`() = runBlocking {
        val sensors = FakeSensorManager(*all)
        val first = DeviceVector(1.0, 2.0, 3.0)
        val told = listOf(first, first, first.copy(x = 4.0), DeviceVector(4.0, 5.0, 3.0), DeviceVector(4.0, 5.0, 6.0), null)
        val samples = collectWhile(sensors, sensors.source(), told.size) {
            told.forEachIndexed { k, it -> sensors.deliver(SensorSample.Magnetic(MagneticSample(k + 1L, DeviceVector(7.0, 8.0, 9.0), it))) }
        }
        assertEquals(told, samples.map { (it as SensorSample.Magnetic).sample.reportedHardIronUt })
    }

    @Test
    fun `a refused gyroscope is told, and the others go on`() = runBlocking {
        val sensors = FakeSensorManager(*all).apply { refuse = Sensor.TYPE_GYROSCOPE }
        val source = sensors.source()
        collectWhile(sensors, source, 1) {
            val used = source.sensors.value!!
            assertEquals(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, used.magnetometer.type)
            assertEquals(Sensor.TYPE_GRAVITY, used.up!!.type)
            assertEquals(null, used.gyroscope)
            assertTrue("refused to deliver the gyroscope" in used.withoutGyroscope!!, used.withoutGyroscope)
            sensors.deliver(Sensor.TYPE_GRAVITY, 1, 0f, 0f, 9.8f)
        }
        assertEquals(0, sensors.registrations.size)
    }

    @Test
    fun `the sensors in use and what the system says of them reach the readings`() = runBlocking {
        val sensors = FakeSensorManager(*all)
        val compass = Compass(sensors.source(), grace = ZERO)
        val readings = mutableListOf<CompensatedReading>()
        val job = launch { compass.readings().take(3).toList(readings) }
        sensors.registered(3)
        suspend fun read(timeNs: Long) {
            sensors.deliver(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, timeNs, 1f, 2f, 3f + timeNs, 0f, 0f, 0f)
            withTimeout(120_000) { while (readings.size < timeNs) yield() }
        }
        read(1)
        sensors.tell(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, SensorManager.SENSOR_STATUS_UNRELIABLE)
        sensors.tell(Sensor.TYPE_GYROSCOPE, SensorManager.SENSOR_STATUS_ACCURACY_HIGH)
        read(2)
        sensors.tell(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, SensorManager.SENSOR_STATUS_NO_CONTACT)
        read(3)
        job.join()
        assertEquals(
            listOf(SensorAccuracy.UNKNOWN, SensorAccuracy.UNRELIABLE, SensorAccuracy.NO_CONTACT),
            readings.map { it.sensors!!.magnetometer.accuracy },
        )
        val last = readings.last().sensors!!
        assertEquals(Pair(SensorAccuracy.HIGH, SensorAccuracy.UNKNOWN), Pair(last.gyroscope!!.accuracy, last.up!!.accuracy))
        assertEquals(null, last.withoutGyroscope)
    }

    @Test
    fun `without a gyroscope it says why`() = runBlocking {
        suspend fun reason(sensors: FakeSensorManager, options: SensorOptions): String? {
            val source = sensors.source(options)
            collectWhile(sensors, source, 1) { sensors.deliver(Sensor.TYPE_GRAVITY, 1, 0f, 0f, 9.8f) }
            return source.sensors.value!!.withoutGyroscope
        }
        val none = FakeSensorManager(Sensor.TYPE_MAGNETIC_FIELD, Sensor.TYPE_GRAVITY)
        assertEquals("this phone has no gyroscope", reason(none, SensorOptions(holdS = 0.0)))
        assertEquals("the gyroscope was not asked for", reason(FakeSensorManager(*all), SensorOptions(gyroscope = false, holdS = 0.0)))
    }

    @Test
    fun `an uncalibrated event without the system's hard iron, or before it has found one`() = runBlocking {
        for (hardIron in listOf(false, true)) {
            val sensors = FakeSensorManager(*all, hardIron = hardIron)
            val samples = collectWhile(sensors, sensors.source(), 1) {
                sensors.deliver(SensorSample.Magnetic(MagneticSample(1, DeviceVector(1.0, 2.0, 3.0))))
            }
            assertEquals(listOf(SensorSample.Magnetic(MagneticSample(1, DeviceVector(1.0, 2.0, 3.0), null))), samples)
        }
    }

    @Test
    fun `a sample at the range that the sensor tells is saturated, unless the app knows another`() = runBlocking {
        suspend fun status(fullScaleUt: Float, config: CompensationConfig = CompensationConfig()): CompensationStatus {
            val sensors = FakeSensorManager(*all, fullScaleUt = fullScaleUt)
            val reading = async { Compass(sensors.source(), config, grace = ZERO).readings().first().reading }
            sensors.registered(3)
            // until the one who asked is there to hear it
            var timeNs = 0L
            while (!reading.isCompleted) {
                timeNs += 10_000_000
                sensors.deliver(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, timeNs, 1f, -1200.5f, 3f)
                delay(1)
            }
            return reading.await().status
        }
        assertEquals(CompensationStatus.Rejected(RejectReason.Saturated(DeviceAxis.Y, -1200.5, 1200.0)), status(1200f))
        assertTrue(status(1201f) is CompensationStatus.Collecting)
        assertTrue(status(1200f, CompensationConfig(railUt = 2000.0)) is CompensationStatus.Collecting)
        for (absurd in listOf(0f, -1f, 99f, 100_001f, Float.NaN, Float.POSITIVE_INFINITY)) {
            assertEquals(null, FakeSensorManager(*all, fullScaleUt = absurd).source().fullScaleUt)
            assertTrue(status(absurd) is CompensationStatus.Collecting, "$absurd")
        }
        assertEquals(null, FakeSensorManager().source().fullScaleUt)
    }

    @Test
    fun `sleep that the sensors' clock does not show is told once, late events are no sleep`() = runBlocking {
        val sensors = FakeSensorManager(*all)
        val source = sensors.source()
        val compass = Compass(source, grace = ZERO)
        val phone = Phone(1)
        val readings = CopyOnWriteArrayList<CompensatedReading>()
        val app = launch { compass.readings().collect { readings += it } }
        sensors.registered(3)
        var sleptS = 0.0
        suspend fun pass(samples: Int, still: Boolean, lateS: (Int) -> Double = { 0.0 }): MagneticReading {
            repeat(samples) { k ->
                val events = phone.advance(still)
                sensors.continuousNs = phone.timeNs + ((sleptS + lateS(k)) * 1e9).toLong()
                events.forEach(sensors::deliver)
            }
            withTimeout(120_000) { while (readings.lastOrNull()?.sample?.timeNs != phone.timeNs) yield() }
            return readings.last().reading
        }
        val compensator = { compass.kept!!.compensator }
        pass(3000, still = false)
        val gaps = compensator().gaps()
        // batches of 5 s, and an event of an hour ago
        pass(1000, still = true) { k -> (500 - k % 500) * 0.01 }
        sensors.deliver(SensorSample.Magnetic(MagneticSample(phone.timeNs - 3_600_000_000_000, HARD_IRON_UT)))
        withTimeout(120_000) { while (readings.last().reading.status !is CompensationStatus.Rejected) yield() }
        val before = pass(1000, still = true) { k -> (500 - k % 500) * 0.01 }
        assertEquals(Pair(0.0, gaps), Pair(source.hiddenS, compensator().gaps()))
        // a nap that is as good as none
        sleptS = 0.9
        pass(200, still = true)
        assertEquals(gaps, compensator().gaps())
        sleptS = 8 * 3600.0
        val after = pass(200, still = true)
        assertEquals(8 * 3600.0, source.hiddenS, 1.0)
        assertEquals(gaps + 1, compensator().gaps())
        assertTrue(before.fieldSigmaUt!! < 6.0, "$before")
        assertTrue((after.fieldSigmaUt ?: 1e9) > 2 * before.fieldSigmaUt!!, "${before.fieldSigmaUt}, then ${after.fieldSigmaUt}")
        app.cancelAndJoin()
    }

    @Test
    fun `each accuracy of the system has its name`() = runBlocking {
        val sensors = FakeSensorManager(*all)
        val source = sensors.source()
        val collecting = launch { source.samples().collect { } }
        sensors.registered(3)
        val expected = listOf(
            SensorManager.SENSOR_STATUS_NO_CONTACT to SensorAccuracy.NO_CONTACT,
            SensorManager.SENSOR_STATUS_UNRELIABLE to SensorAccuracy.UNRELIABLE,
            SensorManager.SENSOR_STATUS_ACCURACY_LOW to SensorAccuracy.LOW,
            SensorManager.SENSOR_STATUS_ACCURACY_MEDIUM to SensorAccuracy.MEDIUM,
            SensorManager.SENSOR_STATUS_ACCURACY_HIGH to SensorAccuracy.HIGH,
            99 to SensorAccuracy.UNKNOWN,
        )
        for ((android, ours) in expected) {
            sensors.tell(Sensor.TYPE_GRAVITY, android)
            assertEquals(ours, source.sensors.value!!.up!!.accuracy)
            assertEquals(SensorAccuracy.UNKNOWN, source.sensors.value!!.magnetometer.accuracy, "of that sensor alone")
        }
        collecting.cancelAndJoin()
    }

    @Test
    fun `without up no sensor of it is used, nor missed`() = runBlocking {
        for (types in listOf(all, intArrayOf(Sensor.TYPE_MAGNETIC_FIELD))) {
            val sensors = FakeSensorManager(*types)
            val source = sensors.source(SensorOptions(up = false, gyroscope = false, holdS = 0.0))
            val collecting = launch { source.samples().collect { } }
            sensors.registered(1)
            assertEquals(listOf(types[0]), sensors.registrations.map { it.sensor.type })
            assertEquals(null, source.sensors.value!!.up)
            collecting.cancelAndJoin()
        }
    }

    @Test
    fun `an event of less than three numbers is none`() = runBlocking {
        val sensors = FakeSensorManager(*all)
        val samples = collectWhile(sensors, sensors.source(), 2) {
            for (length in 0..2) for (type in all) sensors.deliver(type, FloatArray(length))
            // of six the last three are the system's hard iron; of four or five nothing is
            sensors.deliver(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, floatArrayOf(1f, 2f, 3f, 4f, 5f))
            sensors.deliver(Sensor.TYPE_GYROSCOPE, floatArrayOf(1f, 2f, 3f, 4f, 5f))
        }
        val (x, y, z) = listOf(1.0, 2.0, 3.0)
        val expected = listOf(
            SensorSample.Magnetic(MagneticSample(1, DeviceVector(x, y, z), null)),
            SensorSample.RotationRate(RotationRateSample(1, DeviceVector(x, y, z))),
        )
        assertEquals(expected, samples)
    }

    /** The first [count] samples while [play] runs, once the sensors are registered. */
    private suspend fun collectWhile(
        sensors: FakeSensorManager,
        source: SensorManagerSource,
        count: Int,
        play: () -> Unit,
    ): List<SensorSample> = kotlinx.coroutines.coroutineScope {
        val samples = mutableListOf<SensorSample>()
        val job = launch { source.samples().take(count).toList(samples) }
        withTimeout(120_000) { while (source.sensors.value == null && job.isActive) yield() }
        play()
        withTimeout(120_000) { job.join() }
        samples
    }
}
