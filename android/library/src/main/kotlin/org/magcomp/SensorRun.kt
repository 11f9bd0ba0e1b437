package org.magcomp

import android.hardware.Sensor
import android.hardware.SensorEvent
import android.hardware.SensorEventListener
import android.hardware.SensorManager
import android.os.Handler
import android.os.HandlerThread
import kotlinx.coroutines.CompletableDeferred
import kotlinx.coroutines.flow.MutableStateFlow
import kotlinx.coroutines.flow.update
import kotlinx.coroutines.flow.updateAndGet
import org.magcomp.core.*

/** A taker among those of a run. Once it is left nothing is called: [leave] waits for the call that is under way. */
internal class Seat(val taker: EventTaker) {
    private var isLeft = false

    /** What one of its calls threw; none follows. */
    val failure = CompletableDeferred<Throwable>()

    @Synchronized
    fun leave() {
        isLeft = true
    }

    /** An exception here would end the app. */
    inline fun call(what: EventTaker.() -> Unit): Unit = synchronized(this) {
        if (isLeft) return
        try {
            taker.what()
        } catch (e: Throwable) {
            isLeft = true
            failure.complete(e)
        }
    }
}

/**
 * The sensors from the first user of a source to the last: each is registered once, and every event goes to all who take part. No lock is
 * held while a taker is called, but that of its own seat.
 */
internal class SensorRun(
    private val manager: SensorManager,
    private val options: SensorOptions,
    private val told: MutableStateFlow<SensorsInUse?>,
    private val sleep: Sleep,
    private val continuousNs: () -> Long,
) {
    /** Events are delivered and estimated there: no work of the app holds it up. */
    private val thread = HandlerThread("magcomp").apply { start() }
    private val handler = Handler(thread.looper)
    private val listener = Listener()

    /** The array is replaced, never changed. */
    @Volatile
    private var seats = emptyArray<Seat>()
    private val sensors = MutableStateFlow<SensorsInUse?>(null)

    @Volatile
    private var hasEnded = false

    // from here on to the last: of the sensors' thread alone
    private val order = object : EventOrder<RawEvent>(options.heldS) {
        override fun timeNs(event: RawEvent) = event.timeNs

        override fun sensor(event: RawEvent) = event.kind
    }
    private val clocks = Clocks(1_000_000_000L / options.slowestHz, 1000L * options.maxReportLatencyUs)

    // as many as ever wait, which the order bounds
    private val free = ArrayDeque<RawEvent>()
    private val release: (RawEvent) -> Unit = {
        for (seat in seats) seat.call { take(it) }
        free.addLast(it)
    }

    /** Events of each type so far, those at the look before, and at how many looks in a row there was no other. */
    private val events = IntArray(TYPES)
    private val heard = IntArray(TYPES)
    private val looks = IntArray(TYPES)

    /** Registers the sensors for [first], which misses none of their events. Where it throws, none is left registered, and [first] is called no more. */
    fun start(first: Seat, magnetometer: Sensor, up: Sensor?, gyroscope: Sensor?, withoutGyroscope: String?) {
        try {
            // before the first event
            sensors.value = SensorsInUse(used(magnetometer), up?.let(::used), gyroscope?.let(::used), withoutGyroscope)
            add(first)
            register(magnetometer)
            up?.let(::register)
            try {
                gyroscope?.let(::register)
            } catch (e: SensorException.Refused) {
                hearAll { it.copy(gyroscope = null, withoutGyroscope = e.message) }
            }
        } catch (e: SensorException) {
            // before the end, which lets the thread do what was delivered already
            remove(first)
            end()
            throw e
        }
        lookOn()
        publish()
    }

    fun end() {
        hasEnded = true
        manager.unregisterListener(listener)
        // what is delivered already is done first, if this is asked elsewhere
        thread.quitSafely()
    }

    fun add(seat: Seat) {
        // its first event waits until it has heard of the sensors
        synchronized(seat) {
            synchronized(this) { seats += seat }
            seat.taker.heard(sensors.value!!)
        }
    }

    /** Whether anyone is left. When this returns the taker is called no more, unless one of its own calls asked for it. */
    fun remove(seat: Seat): Boolean {
        val others = synchronized(this) { seats.filter { it !== seat }.toTypedArray().also { seats = it } }
        seat.leave()
        return others.isNotEmpty()
    }

    /** Tells the app, which may run code of its own when it hears of it. Two of these may overtake one another. */
    private fun publish() = Handover.executor.execute { told.update { if (hasEnded) it else sensors.value } }

    private fun register(sensor: Sensor) {
        val rateHz = options.rateHz(sensor.type)
        val periodUs = 1_000_000 / rateHz
        val accepted = try {
            manager.registerListener(listener, sensor, periodUs, options.maxReportLatencyUs, handler)
        } catch (e: SecurityException) {
            if (rateHz > SensorManagerSource.FREE_RATE_HZ) throw SensorException.PermissionMissing(SensorManagerSource.HIGH_RATE, e)
            throw SensorException.Refused(nameOf(sensor.type), e.message, e, "let the app use this phone's sensors")
        } catch (e: IllegalStateException) {
            // what Android throws at the 129th listener of an app
            throw SensorException.Refused(nameOf(sensor.type), e.message, e)
        }
        if (!accepted) throw SensorException.Refused(nameOf(sensor.type))
    }

    /** Looks again and again until the thread ends. This clock stands while the phone sleeps. */
    private fun lookOn() {
        val periodMs = (SILENCE_MS + options.maxReportLatencyUs / 1000 + 1000 / options.slowestHz) / LOOKS
        handler.postDelayed(
            {
                if (seats.isNotEmpty()) look()
                lookOn()
            },
            periodMs,
        )
    }

    /** Looks which sensors have delivered nothing since the look before, and tells who has been silent for so many. */
    private fun look() {
        val before = sensors.value!!
        val used = setOf(before.magnetometer.type, before.up?.type, before.gyroscope?.type)
        for (type in 0 until TYPES) {
            looks[type] = if (type in used && events[type] == heard[type]) looks[type] + 1 else 0
            heard[type] = events[type]
        }
        hear { if (it.isSilent == (looks[it.type] >= LOOKS)) it else it.copy(isSilent = !it.isSilent) }
        replaceGravity()
    }

    /** What was found of the sensors, where it is news. */
    private fun hear(change: (UsedSensor) -> UsedSensor) = hearAll { it.with(change) }

    private fun hearAll(change: (SensorsInUse) -> SensorsInUse) {
        val before = sensors.value!!
        val now = sensors.updateAndGet { change(it!!) }!!
        if (now == before) return
        publish()
        for (seat in seats) seat.call { heard(now) }
    }

    /** The accelerometer for gravity where that is silent and another sensor is not; all are while the app is in the background. */
    private fun replaceGravity() {
        val now = sensors.value!!
        val gravity = now.up?.takeIf { it.type == Sensor.TYPE_GRAVITY && it.isSilent } ?: return
        if (now.magnetometer.isSilent && now.gyroscope?.isSilent != false) return
        val accelerometer = manager.getDefaultSensor(Sensor.TYPE_ACCELEROMETER) ?: return
        try {
            register(accelerometer)
        } catch (_: SensorException) {
            // gravity stays, and what is told of it
            return
        }
        manager.unregisterListener(listener, manager.getDefaultSensor(gravity.type))
        hearAll { it.copy(up = used(accelerometer)) }
    }

    /** Copies an event at once: Android uses it again for the next. */
    private inner class Listener : SensorEventListener {
        private var bias: DeviceVector? = null

        override fun onSensorChanged(event: SensorEvent) {
            Handover.delivers()
            val v = event.values
            val type = event.sensor.type
            // an exception here would end the app; so it counts as none, and its sensor as silent
            if (v.size < 3) return
            val kind = when (type) {
                Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_MAGNETIC_FIELD -> RawEvent.MAGNETIC
                Sensor.TYPE_GYROSCOPE -> RawEvent.ROTATION_RATE
                Sensor.TYPE_GRAVITY, Sensor.TYPE_ACCELEROMETER -> RawEvent.UP
                else -> return
            }
            // that of gravity which came before the accelerometer took over is none of the one in use
            if (kind == RawEvent.UP && type != sensors.value!!.up?.type) return
            events[type] += 1
            if (looks[type] >= LOOKS) {
                looks[type] = 0
                hear { if (it.type == type) it.copy(isSilent = false) else it }
            }
            val nowNs = continuousNs()
            if (kind == RawEvent.MAGNETIC) sleep.see(event.timestamp, nowNs)
            val timeNs = clocks.magnetometersNs(kind, event.timestamp, nowNs)
            if (clocks.hasChanged) {
                order.flush(release)
                for (seat in seats) seat.call { anotherClock() }
            }
            val reported = if (type == Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED && v.size >= 6) bias(v) else null
            val raw = free.removeLastOrNull() ?: RawEvent()
            raw.set(kind, timeNs, v[0].toDouble(), v[1].toDouble(), v[2].toDouble(), reported, event.timestamp)
            if (kind == RawEvent.MAGNETIC) raw.accuracy = sensors.value!!.magnetometer.accuracy
            order.push(raw, release)
        }

        /** The object of before where it is the same. Some phones deliver no bias, and 0 until they have found one. */
        private fun bias(v: FloatArray): DeviceVector? {
            if (v[3] == 0f && v[4] == 0f && v[5] == 0f) return null
            bias?.let { if (it.x == v[3].toDouble() && it.y == v[4].toDouble() && it.z == v[5].toDouble()) return it }
            return DeviceVector(v[3].toDouble(), v[4].toDouble(), v[5].toDouble()).also { bias = it }
        }

        override fun onAccuracyChanged(sensor: Sensor?, accuracy: Int) = hear { if (it.type == sensor?.type) it.copy(accuracy = accuracyOf(accuracy)) else it }
    }

    private companion object {
        const val SILENCE_MS = 2000L

        /** As often it is looked within that time. */
        const val LOOKS = 4

        /** Android's types that are used are all less. */
        const val TYPES = Sensor.TYPE_GYROSCOPE_UNCALIBRATED

        fun used(sensor: Sensor) = UsedSensor(sensor.type, sensor.name.orEmpty(), sensor.vendor.orEmpty(), SensorAccuracy.UNKNOWN)

        fun SensorsInUse.with(change: (UsedSensor) -> UsedSensor) =
            copy(magnetometer = change(magnetometer), up = up?.let(change), gyroscope = gyroscope?.let(change))

        fun accuracyOf(status: Int): SensorAccuracy = when (status) {
            SensorManager.SENSOR_STATUS_NO_CONTACT -> SensorAccuracy.NO_CONTACT
            SensorManager.SENSOR_STATUS_UNRELIABLE -> SensorAccuracy.UNRELIABLE
            SensorManager.SENSOR_STATUS_ACCURACY_LOW -> SensorAccuracy.LOW
            SensorManager.SENSOR_STATUS_ACCURACY_MEDIUM -> SensorAccuracy.MEDIUM
            SensorManager.SENSOR_STATUS_ACCURACY_HIGH -> SensorAccuracy.HIGH
            else -> SensorAccuracy.UNKNOWN
        }

        fun nameOf(type: Int): String = when (type) {
            Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_MAGNETIC_FIELD -> "magnetometer"
            Sensor.TYPE_GYROSCOPE -> "gyroscope"
            Sensor.TYPE_GRAVITY -> "gravity sensor"
            else -> "accelerometer"
        }
    }
}
