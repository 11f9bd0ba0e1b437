package org.magcomp

import java.io.File
import java.util.Random
import kotlin.time.Duration.Companion.ZERO
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.flow.Flow
import kotlinx.coroutines.flow.asFlow
import kotlinx.coroutines.flow.emitAll
import kotlinx.coroutines.flow.flow
import org.magcomp.core.*

/** What the feature `test-hooks` adds to the library for these tests. */
object TestHooks {
    init {
        System.loadLibrary("magcomp_ffi")
    }

    /** Panics inside the object of a handle. */
    @JvmStatic
    external fun panicOnPurpose(handle: Long): Int

    /** Nanoseconds the core itself takes for these samples. */
    @JvmStatic
    external fun barePushNs(constant: Boolean, nMin: Int, stepNs: Long, values: DoubleArray): Long
}

/** Run in a process of its own: what the library says at a level. */
object LoggingMain {
    @JvmStatic
    fun main(arguments: Array<String>) {
        startLogging("compass-app", MagcompLogLevel.valueOf(arguments.single()))
        Compensator().use {
            // no phone has a hard iron this large
            it.push(MagneticSample(1, DeviceVector(1.0, 2.0, 3.0), DeviceVector(0.0, 9000.0, 0.0)))
        }
        NativeCompensator(CompensationConfig()).use { TestHooks.panicOnPurpose(it.fastHandle()) }
    }
}

/** Run in a process of its own: whether preloading loads the library, as the process' own list of files has it. */
object PreloadMain {
    private fun isLoaded() = File("/proc/self/maps").readText().contains("libmagcomp_ffi")

    @JvmStatic
    fun main(arguments: Array<String>) {
        print(if (isLoaded()) "loaded, " else "not loaded, ")
        repeat(2) { Compass.preload() }
        for (look in 1..12_000) if (isLoaded()) break else Thread.sleep(10)
        println(if (isLoaded()) "loaded" else "not loaded")
    }
}

/** Run in a process of its own, with the JVM's checks of JNI: every function of the fast path, and every way it can end. */
object CheckedMain {
    @JvmStatic
    fun main(arguments: Array<String>) {
        val compensator = Compensator()
        compensator.pushAll(events(tumbling(300)))
        val out = ReadingBuffer()
        for (k in 301L..400) {
            compensator.pushRotationRate(k * STEP_NS, 0.0, 0.0, 0.0)
            compensator.pushUp(k * STEP_NS, 0.0, 0.0, 9.8)
            compensator.push(k * STEP_NS, 1.0, 2.0, k.toDouble(), out)
        }
        try {
            FastPath.push(compensator.handle, 1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, DoubleArray(1))
            error("an array that is too short was taken")
        } catch (_: ArrayIndexOutOfBoundsException) {
            // the JVM's own
        }
        check(TestHooks.panicOnPurpose(compensator.handle) == FastPath.PANICKED)
        check(FastPath.pushUp(compensator.handle, 1, 0.0, 0.0, 0.0) == FastPath.PANICKED)
        compensator.close()
        check(FastPath.pushUp(compensator.handle, 1, 0.0, 0.0, 0.0) == FastPath.CLOSED)
        println("checked: " + java.lang.management.ManagementFactory.getRuntimeMXBean().inputArguments.last())
    }
}

val repository: File = File(System.getProperty("repository.root"))

/** A device tumbled in a field of 50 uT, noise 0.3 uT, around a hard iron of (120, -80, 300) uT: three values each. */
fun tumbling(samples: Int, seed: Long = 1): DoubleArray {
    val random = Random(seed)
    val values = DoubleArray(3 * samples)
    for (k in 0 until samples) {
        val field = direction(k)
        for (axis in 0..2) {
            values[3 * k + axis] = 50.0 * field[axis] + HARD_IRON[axis] + 0.3 * random.nextGaussian()
        }
    }
    return values
}

/** Where the field points in the device, sample by sample. */
private fun direction(k: Int): DoubleArray {
    val (a, b) = Pair(k * 0.11, k * 0.031)
    return doubleArrayOf(Math.cos(a) * Math.cos(b), Math.sin(a) * Math.cos(b), Math.sin(b))
}

/** Gravity in the device: the field dips by 53 degrees wherever the device points. */
fun up(k: Int): DeviceVector {
    val (x, y, z) = direction(k)
    return DeviceVector(9.81 * (-0.8 * x - 0.6 * Math.sin(k * 0.11)), 9.81 * (-0.8 * y + 0.6 * Math.cos(k * 0.11)), -9.81 * 0.8 * z)
}

val HARD_IRON = doubleArrayOf(120.0, -80.0, 300.0)

/** 100 Hz. */
const val STEP_NS = 10_000_000L

/** After a longer silence of all sensors nothing of the vertical from before is left. */
const val PAUSE_NS = 2_000_000_000L

/** The same as events, with `up` beside every sample: the one that belongs to sample [at] and the next ones. */
fun events(values: DoubleArray, beginNs: Long = 0, at: Int = 0): List<SensorSample> = (0 until values.size / 3).flatMap { k ->
    val timeNs = beginNs + (k + 1) * STEP_NS
    val field = DeviceVector(values[3 * k], values[3 * k + 1], values[3 * k + 2])
    listOf(
        SensorSample.Up(UpSample(timeNs, up(at + k))),
        SensorSample.Magnetic(MagneticSample(timeNs, field)),
    )
}

/** One more sample, number [k], of a device that lies flat. */
fun flat(k: Int): List<SensorSample> {
    val timeNs = (k + 1) * STEP_NS
    val field = DeviceVector(HARD_IRON[0] + 10.0, HARD_IRON[1] + 28.0, HARD_IRON[2] - 40.0)
    return listOf(SensorSample.Up(UpSample(timeNs, DeviceVector(0.0, 0.0, 9.81))), SensorSample.Magnetic(MagneticSample(timeNs, field)))
}

/** A kept calibration as if a newer version of the library had written it. */
fun newer(text: String) = text.replaceFirst(Regex("\"magcomp_calibration\": ?\\d+"), "\"magcomp_calibration\":99")

/** Plays these events to all who collect. */
class Played(private val events: Flow<SensorSample>) : FlowSource() {
    constructor(events: List<SensorSample>) : this(events.asFlow())

    override fun played() = events
}

/** A source of an app's own, whose events are a flow. */
abstract class FlowSource : MagneticFieldSource {
    abstract fun played(): Flow<SensorSample>

    override suspend fun deliver(taker: EventTaker) {
        val event = RawEvent()
        played().collect { taker.take(event.set(it)) }
    }
}

/** Every answer of a compass of its own to these events. Its store is called where its readings are made. */
internal fun Flow<SensorSample>.compensated(
    config: CompensationConfig = CompensationConfig(),
    store: CalibrationStore? = null,
): Flow<CompensatedReading> = flow {
    val one = Dispatchers.Default.limitedParallelism(1)
    Compass(Played(this@compensated), config, store, grace = ZERO, one, Dispatchers.Unconfined).use { emitAll(it.readings()) }
}

/** What a screen that is not turned shows of a reading. */
fun shown(reading: CompensatedReading) = CompassReading(reading.answer, ReferenceAxis.AUTO, ScreenRotation.DEG0)

/** A time of the wall clock, seconds since 1970. */
const val NOW_S = 1_795_000_000L

/** An event as Android delivers it. */
fun inFloats(event: SensorSample): SensorSample {
    fun DeviceVector.inFloats() = DeviceVector(x.toFloat().toDouble(), y.toFloat().toDouble(), z.toFloat().toDouble())
    return when (event) {
        is SensorSample.Magnetic -> SensorSample.Magnetic(event.sample.copy(fieldUt = event.sample.fieldUt.inFloats()))
        is SensorSample.RotationRate -> SensorSample.RotationRate(event.sample.copy(rateRadS = event.sample.rateRadS.inFloats()))
        is SensorSample.Up -> SensorSample.Up(event.sample.copy(upMS2 = event.sample.upMS2.inFloats()))
    }
}

/** What a main class prints, in a process of its own. */
fun inProcessOfItsOwn(main: String, vararg arguments: String, options: List<String> = emptyList()): String {
    val java = File(System.getProperty("java.home"), "bin/java").path
    val command = listOf(java) + options + listOf("-cp", System.getProperty("java.class.path"), main) + arguments
    val process = ProcessBuilder(command).redirectErrorStream(true).start()
    val text = process.inputStream.bufferedReader().readText()
    check(process.waitFor() == 0) { text }
    return text
}
