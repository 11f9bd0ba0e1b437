package org.magcomp

import java.io.File
import java.lang.management.ManagementFactory
import java.util.concurrent.ConcurrentLinkedQueue
import java.util.concurrent.CountDownLatch
import kotlin.concurrent.thread
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

class LimitsTest {
    private val values = tumbling(1000)

    @Test
    fun `eight threads push and close, over JNI and uniffi`() {
        val wrong = ConcurrentLinkedQueue<Throwable>()
        var answered = 0
        repeat(60) { round ->
            val compensator = Compensator()
            val begin = CountDownLatch(1)
            val pushed = java.util.concurrent.atomic.AtomicInteger()
            val threads = (0 until 8).map { number ->
                thread {
                    val out = ReadingBuffer()
                    begin.await()
                    try {
                        for (k in 0 until 300) {
                            val timeNs = (k * 8L + number + 1) * 1000
                            compensator.push(timeNs, values[3 * k], values[3 * k + 1], values[3 * k + 2], out)
                            compensator.pushUp(timeNs, 0.0, 0.0, 9.8)
                            pushed.incrementAndGet()
                            if (k % 50 == 10) compensator.coverage()
                            if (number == 7 && k == 4 * round) compensator.close()
                        }
                    } catch (_: MagcompException.Closed) {
                        // as it should
                    } catch (e: Throwable) {
                        wrong += e
                    }
                }
            }
            begin.countDown()
            threads.forEach { it.join() }
            answered += pushed.get()
            compensator.close()
        }
        assertEquals(emptyList<Throwable>(), wrong.toList())
        assertTrue(answered > 60 * 8, "$answered pushes got through")
    }

    @Test
    fun `a push allocates nothing`() {
        val threads = ManagementFactory.getThreadMXBean() as com.sun.management.ThreadMXBean
        Compensator().use { compensator ->
            val out = ReadingBuffer()
            var time = pushAll(compensator, out, 0)
            val before = threads.currentThreadAllocatedBytes
            val baseline = threads.currentThreadAllocatedBytes - before
            val begin = threads.currentThreadAllocatedBytes
            time = pushAll(compensator, out, time)
            val allocated = threads.currentThreadAllocatedBytes - begin - baseline
            assertEquals(0, allocated, "bytes in ${values.size / 3} times three pushes")
            assertEquals(time, out.timeNs)
        }
    }

    @Test
    fun `a million pushes do not grow the heaps`() {
        Compensator().use { compensator ->
            val out = ReadingBuffer()
            var time = 0L
            repeat(100) { time = pushAll(compensator, out, time) }
            val (java, native) = Pair(usedHeap(), residentBytes())
            repeat(PUSHES / (3 * 1000)) { time = pushAll(compensator, out, time) }
            assertTrue(usedHeap() - java < MEGABYTE, "Java heap grew by ${usedHeap() - java} bytes")
            // 16 bytes lost in every push would show
            assertTrue(residentBytes() - native < 12 * MEGABYTE, "resident memory grew by ${residentBytes() - native} bytes")
        }
    }

    @Test
    fun `compensators that are never closed are freed`() {
        repeat(200) { Compensator().push(1, 1.0, 2.0, 3.0, ReadingBuffer()) }
        collect()
        val before = residentBytes()
        repeat(20) {
            // each has a window of 100 kB and more
            repeat(100) { Compensator().push(1, 1.0, 2.0, 3.0, ReadingBuffer()) }
            collect()
        }
        assertTrue(residentBytes() - before < 100 * MEGABYTE, "resident memory grew by ${residentBytes() - before} bytes")
    }

    /** Three pushes for every sample; the time of the last. */
    private fun pushAll(compensator: Compensator, out: ReadingBuffer, beginNs: Long): Long {
        var timeNs = beginNs
        for (k in 0 until values.size / 3) {
            timeNs += STEP_NS
            compensator.pushRotationRate(timeNs, 0.1, 0.2, 0.3)
            compensator.pushUp(timeNs, 0.0, 0.0, 9.8)
            compensator.push(timeNs, values[3 * k], values[3 * k + 1], values[3 * k + 2], out)
        }
        return timeNs
    }

    private fun usedHeap(): Long {
        collect()
        return ManagementFactory.getMemoryMXBean().heapMemoryUsage.used
    }

    private fun collect() {
        repeat(3) {
            System.gc()
            Thread.sleep(20)
        }
    }

    private fun residentBytes(): Long = File("/proc/self/statm").readText().split(' ')[1].toLong() * 4096

    private companion object {
        const val MEGABYTE = 1L shl 20
        const val PUSHES = 1_000_000
    }
}
