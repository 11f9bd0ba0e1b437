package org.magcomp

import java.lang.management.ManagementFactory
import java.util.Locale
import org.junit.jupiter.api.Test
import org.magcomp.core.*

/**
 * What one magnetometer push costs: in bare Rust, over JNI, over uniffi and JNA, on the same samples. A round takes a
 * few milliseconds and has every way in turn, so that what else the machine does counts for all; the median of the
 * rounds' differences is what the border adds. Not among the tests, since it asserts nothing: `tests/benchmark.sh` runs
 * it.
 */
class Benchmark {
    private class Cost(val ns: Double, val bytes: Double)

    private class Case(val name: String, val constant: Boolean, val nMin: Int, val samples: Int, val rounds: Int)

    private var samples = DoubleArray(0)
    private val threads = ManagementFactory.getThreadMXBean() as com.sun.management.ThreadMXBean

    @Test
    fun push() {
        println("one push on the host JVM; median (least) of the rounds")
        for (case in listOf(
            // next to nothing to compute, so that the border shows
            Case("constant calibration, sigma_T over 9 samples", constant = true, nMin = 9, samples = 1000, rounds = 2000),
            Case("the paper's method, a fit at every sample", constant = false, nMin = 100, samples = 200, rounds = 1000),
        )) {
            println(case.name)
            println(String.format(Locale.ROOT, "  %-20s %18s %25s %10s", "", "ns", "ns over bare Rust", "bytes"))
            run(case)
        }
    }

    private fun run(case: Case) {
        samples = tumbling(case.samples)
        val config = CompensationConfig(
            method = if (case.constant) CompensationMethod.CONSTANT else CompensationMethod.WINDOWED,
            initial = MagnetometerCalibration(SoftIron(1.0, 1.0, 1.0, 0.0, 0.0, 0.0), DeviceVector(0.0, 0.0, 0.0), 50.0).takeIf { case.constant },
            windowed = WindowedConfig(nMin = case.nMin),
        )
        val ways = linkedMapOf<String, () -> Cost>(
            "bare Rust" to { Cost(TestHooks.barePushNs(case.constant, case.nMin, STEP_NS, samples).toDouble() / case.samples, 0.0) },
            "JNI" to { overJni(config) },
            "JNI, as records" to { overJniAsRecords(config) },
            "uniffi, JNA" to { overUniffi(config) },
        )
        val rounds = List(case.rounds + WARM_UP) { round ->
            // JNA takes as long as all the rest a hundred times over
            ways.mapValues { (way, measure) -> if (way != "uniffi, JNA" || round % JNA_EVERY == 0) measure() else null }
        }.drop(WARM_UP)
        for (way in ways.keys) {
            val (ns, over) = rounds.mapNotNull { round -> round[way]?.let { it.ns to it.ns - round.getValue("bare Rust")!!.ns } }.unzip()
            val bytes = rounds.mapNotNull { it[way]?.bytes }
            println(
                String.format(
                    Locale.ROOT, "  %-20s %9.0f (%6.0f) %+16.0f (%+6.0f) %10.1f",
                    way, median(ns), ns.min(), median(over), ns.min() - rounds.minOf { it.getValue("bare Rust")!!.ns }, median(bytes),
                ),
            )
        }
    }

    private fun overJni(config: CompensationConfig): Cost = Compensator(config).use { compensator ->
        val out = ReadingBuffer()
        measure { k -> compensator.push((k + 1) * STEP_NS, samples[3 * k], samples[3 * k + 1], samples[3 * k + 2], out) }
    }

    private fun overJniAsRecords(config: CompensationConfig): Cost = Compensator(config).use { compensator ->
        measure { k -> compensator.push(sample(k)) }
    }

    private fun overUniffi(config: CompensationConfig): Cost = NativeCompensator(config).use { native ->
        measure { k -> native.push(sample(k)) }
    }

    private fun sample(k: Int) =
        MagneticSample((k + 1) * STEP_NS, DeviceVector(samples[3 * k], samples[3 * k + 1], samples[3 * k + 2]))

    private inline fun measure(push: (Int) -> Unit): Cost {
        val bytes = threads.currentThreadAllocatedBytes
        val begin = System.nanoTime()
        val count = samples.size / 3
        for (k in 0 until count) push(k)
        val ns = System.nanoTime() - begin
        return Cost(ns.toDouble() / count, (threads.currentThreadAllocatedBytes - bytes).toDouble() / count)
    }

    private fun median(values: List<Double>) = values.sorted()[values.size / 2]

    private companion object {
        const val WARM_UP = 20
        const val JNA_EVERY = 20
    }
}
