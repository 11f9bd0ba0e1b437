package org.magcomp

import java.lang.management.ManagementFactory
import java.util.Locale
import org.junit.jupiter.api.Test

/**
 * What one magnetometer push costs: in bare Rust, over JNI, over uniffi and JNA, on the same samples, in turns. Not among
 * the tests, since it asserts nothing: `tests/benchmark.sh` runs it.
 */
class Benchmark {
    private class Cost(val ns: Double, val bytes: Double)

    private val samples = tumbling(SAMPLES)
    private val threads = ManagementFactory.getThreadMXBean() as com.sun.management.ThreadMXBean

    @Test
    fun push() {
        println("ns and bytes of Java heap for one push: median of $ROUNDS rounds of $SAMPLES samples, in turns")
        for ((name, constant) in listOf("constant calibration" to true, "windowed, a fit at every sample" to false)) {
            val config = Config(method = if (constant) Method.CONSTANT else Method.WINDOWED)
            val ways = linkedMapOf<String, () -> Cost>(
                "bare Rust" to { Cost(TestHooks.barePushNs(constant, STEP_NS, samples).toDouble() / SAMPLES, 0.0) },
                "JNI" to { overJni(config) },
                "JNI, as records" to { overJniAsRecords(config) },
                "uniffi, JNA" to { overUniffi(config) },
            )
            val rounds = List(ROUNDS + WARM_UP) { ways.mapValues { (_, measure) -> measure() } }.drop(WARM_UP)
            println(name)
            val bare = median(rounds.map { it.getValue("bare Rust").ns })
            for (way in ways.keys) {
                val ns = median(rounds.map { it.getValue(way).ns })
                // in turns: the machine's other work counts for both
                val over = median(rounds.map { it.getValue(way).ns - it.getValue("bare Rust").ns })
                val bytes = median(rounds.map { it.getValue(way).bytes })
                println(String.format(Locale.ROOT, "  %-18s %9.0f ns  %+9.0f over bare  %8.1f bytes", way, ns, over, bytes))
            }
            check(bare > 0)
        }
    }

    private fun overJni(config: Config): Cost = Compensator(config).use { compensator ->
        val out = ReadingBuffer()
        measure { k -> compensator.push((k + 1) * STEP_NS, samples[3 * k], samples[3 * k + 1], samples[3 * k + 2], out) }
    }

    private fun overJniAsRecords(config: Config): Cost = Compensator(config).use { compensator ->
        measure { k -> compensator.push(sample(k)) }
    }

    private fun overUniffi(config: Config): Cost = NativeCompensator(config).use { native ->
        measure { k -> native.push(sample(k)) }
    }

    private fun sample(k: Int) =
        MagneticSample((k + 1) * STEP_NS, Vector3(samples[3 * k], samples[3 * k + 1], samples[3 * k + 2]))

    private inline fun measure(push: (Int) -> Unit): Cost {
        val bytes = threads.currentThreadAllocatedBytes
        val begin = System.nanoTime()
        for (k in 0 until SAMPLES) push(k)
        val ns = System.nanoTime() - begin
        return Cost(ns.toDouble() / SAMPLES, (threads.currentThreadAllocatedBytes - bytes).toDouble() / SAMPLES)
    }

    private fun median(values: List<Double>) = values.sorted()[values.size / 2]

    private companion object {
        const val SAMPLES = 20_000
        const val ROUNDS = 9
        const val WARM_UP = 3
    }
}
