package org.magcomp

import android.hardware.HardwareBuffer
import android.hardware.Sensor
import android.hardware.SensorAdditionalInfo
import android.hardware.SensorDirectChannel
import android.hardware.SensorEvent
import android.hardware.SensorEventListener
import android.hardware.SensorManager
import android.hardware.TriggerEventListener
import android.os.Handler
import android.os.HandlerThread
import android.os.MemoryFile
import java.util.concurrent.CopyOnWriteArrayList
import java.util.concurrent.Executor
import java.util.concurrent.atomic.AtomicInteger
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.asExecutor
import kotlinx.coroutines.withTimeout
import kotlinx.coroutines.yield
import org.magcomp.core.*

/** Android's own abstract class with sensors that a test plays. As on a phone, each sensor's event object is used again. */
class FakeSensorManager(vararg types: Int, hardIron: Boolean = true, fullScaleUt: Float = 0f) : SensorManager() {
    data class Registration(val listener: SensorEventListener, val sensor: Sensor, val periodUs: Int, val latencyUs: Int)

    private val sensors = types.associateWith { sensor(it, fullScaleUt) }
    private val events = types.associateWith {
        SensorEvent(sensors.getValue(it), 0, 0, FloatArray(if (it == Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED && hardIron) 6 else 3))
    }
    val registrations = CopyOnWriteArrayList<Registration>()

    /** Threads of its sources that have not ended. */
    val threads: Int get() = HandlerThread.RUNNING.get() - threadsBefore
    private val threadsBefore = HandlerThread.RUNNING.get()

    /** The most registrations a sensor had at a time. */
    val most = AtomicInteger()
    var refuse: Int? = null

    /** Called when a listener is about to be unregistered. */
    var unregistering: () -> Unit = {}

    /** The clock that counts sleep, when an event is delivered, ns. */
    @Volatile
    var continuousNs = 0L
    var forbid = false

    /**
     * A source over these sensors, whose events come on the test's thread, in the order it delivers them. So do readings to a collector that is not
     * confined; with another executor for the [Handover] they do as in an app.
     */
    internal fun source(options: SensorOptions = SensorOptions(holdS = 0.0), permitted: Boolean = true, executor: Executor = AT_ONCE): SensorManagerSource {
        Handover.executor = executor
        return SensorManagerSource(this, options, { continuousNs }) { permitted }
    }

    /** Waits until so many are registered. */
    suspend fun registered(count: Int) = withTimeout(120_000) { while (registrations.size < count) yield() }

    /** Delivers an event of a type to whoever listens to it. */
    fun deliver(type: Int, timeNs: Long, vararg values: Float) {
        val event = events.getValue(type)
        event.timestamp = timeNs
        values.copyInto(event.values)
        for (registration in registrations) {
            if (registration.sensor === event.sensor) registration.listener.onSensorChanged(event)
        }
    }

    /** Delivers an event to the sensors of a phone with gravity and an uncalibrated magnetometer. */
    fun deliver(event: SensorSample) {
        fun to(type: Int, v: DeviceVector, bias: DeviceVector? = null) {
            val all = listOf(v.x, v.y, v.z) + (bias ?: DeviceVector(0.0, 0.0, 0.0)).let { listOf(it.x, it.y, it.z) }
            deliver(type, event.timeNs, *all.take(events.getValue(type).values.size).map { it.toFloat() }.toFloatArray())
        }
        when (event) {
            is SensorSample.Magnetic -> to(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, event.sample.fieldUt, event.sample.reportedHardIronUt)
            is SensorSample.RotationRate -> to(Sensor.TYPE_GYROSCOPE, event.sample.rateRadS)
            is SensorSample.Up -> to(Sensor.TYPE_GRAVITY, event.sample.upMS2)
        }
    }

    /** Delivers an event of a length of its own. */
    fun deliver(type: Int, values: FloatArray) {
        for (registration in registrations) {
            if (registration.sensor.type == type) registration.listener.onSensorChanged(SensorEvent(registration.sensor, 0, 1, values))
        }
    }

    /** What the system says of a sensor. */
    fun tell(type: Int, accuracy: Int) {
        for (registration in registrations) {
            if (registration.sensor.type == type) registration.listener.onAccuracyChanged(registration.sensor, accuracy)
        }
    }

    override fun getDefaultSensor(type: Int): Sensor? = sensors[type]

    override fun getFullSensorList(): List<Sensor> = sensors.values.toList()

    override fun registerListenerImpl(
        listener: SensorEventListener,
        sensor: Sensor,
        delayUs: Int,
        handler: Handler?,
        maxReportLatencyUs: Int,
        reservedFlags: Int,
    ): Boolean {
        // as Android's SystemSensorManager counts: at every sensor, even of a listener that is among them
        check(registrations.distinctBy { it.listener }.size < LISTENER_LIMIT) {
            "register failed, the sensor listeners size has exceeded the maximum limit $LISTENER_LIMIT"
        }
        // without one the events would come on the main thread
        check(listener is Silent || handler?.looper in HandlerThread.LOOPERS) { "registered for another thread than a running one of its own" }
        if (forbid) throw SecurityException("the permission is missing")
        if (sensor.type == refuse) return false
        registrations += Registration(listener, sensor, delayUs, maxReportLatencyUs)
        most.accumulateAndGet(registrations.count { it.sensor === sensor }, ::maxOf)
        return true
    }

    override fun unregisterListenerImpl(listener: SensorEventListener, sensor: Sensor?) {
        unregistering()
        registrations.removeIf { it.listener === listener && (sensor == null || it.sensor === sensor) }
    }

    override fun getFullDynamicSensorList(): List<Sensor> = emptyList()

    override fun flushImpl(listener: SensorEventListener): Boolean = true

    override fun createDirectChannelImpl(memoryFile: MemoryFile?, hardwareBuffer: HardwareBuffer?): SensorDirectChannel =
        throw UnsupportedOperationException()

    override fun destroyDirectChannelImpl(channel: SensorDirectChannel) = Unit

    override fun configureDirectChannelImpl(channel: SensorDirectChannel, s: Sensor?, rate: Int): Int = 0

    override fun registerDynamicSensorCallbackImpl(callback: DynamicSensorCallback, handler: Handler?) = Unit

    override fun unregisterDynamicSensorCallbackImpl(callback: DynamicSensorCallback) = Unit

    override fun requestTriggerSensorImpl(listener: TriggerEventListener, sensor: Sensor): Boolean = false

    override fun cancelTriggerSensorImpl(listener: TriggerEventListener, sensor: Sensor?, disable: Boolean): Boolean = false

    override fun initDataInjectionImpl(enable: Boolean, mode: Int): Boolean = false

    override fun injectSensorDataImpl(sensor: Sensor, values: FloatArray, accuracy: Int, timestamp: Long): Boolean = false

    override fun setOperationParameterImpl(parameter: SensorAdditionalInfo): Boolean = false

    /** A listener of someone else. */
    class Silent : SensorEventListener {
        override fun onSensorChanged(event: SensorEvent) = Unit

        override fun onAccuracyChanged(sensor: Sensor?, accuracy: Int) = Unit
    }

    companion object {
        const val LISTENER_LIMIT = 128

        private val AT_ONCE = Executor { it.run() }

        /** As in an app. */
        val ELSEWHERE: Executor = Dispatchers.IO.asExecutor()

        /** Apps can't make a Sensor: its constructor and its type are Android's own. */
        private fun sensor(type: Int, fullScaleUt: Float): Sensor {
            val sensor = Sensor::class.java.getDeclaredConstructor().apply { isAccessible = true }.newInstance()
            Sensor::class.java.getDeclaredField("mType").apply { isAccessible = true }.setInt(sensor, type)
            val isUp = type == Sensor.TYPE_ACCELEROMETER
            for ((field, text) in listOf("mName" to if (isUp) "a" else "m\"1\"", "mVendor" to if (isUp) "maker" else "maker, inc")) {
                Sensor::class.java.getDeclaredField(field).apply { isAccessible = true }.set(sensor, text)
            }
            Sensor::class.java.getDeclaredField("mMaxRange").apply { isAccessible = true }.setFloat(sensor, fullScaleUt)
            return sensor
        }
    }
}
