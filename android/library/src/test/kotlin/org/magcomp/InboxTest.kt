package org.magcomp

import java.util.concurrent.atomic.AtomicInteger
import kotlin.concurrent.thread
import kotlinx.coroutines.runBlocking
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertThrows
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

class InboxTest {
    private class EndOfTest : Exception()

    private val event = RawEvent()

    private fun Inbox.put(timeNs: Long) = take(event.apply { set(RawEvent.UP, timeNs, 1.0, 2.0, 3.0) })

    @Test
    fun `what comes before the collector waits, copied, though the event is used again`() {
        val inbox = Inbox(most = 5000)
        for (k in 1L..5000) inbox.put(k)
        inbox.end(EndOfTest())
        val got = mutableListOf<SensorSample>()
        assertThrows(EndOfTest::class.java) { runBlocking { inbox.each { got += it.toSample() } } }
        assertEquals(List(5000) { SensorSample.Up(UpSample(it + 1L, DeviceVector(1.0, 2.0, 3.0))) }, got)
    }

    @Test
    fun `one too many is an error, which comes after those that have waited`() {
        val inbox = Inbox(most = 3)
        Handover.delivers()
        for (k in 1L..3) inbox.put(k)
        val error = assertThrows(SensorException.NotTaken::class.java) { inbox.put(4) }
        assertEquals(3, error.events)
        inbox.end(error)
        val got = mutableListOf<Long>()
        assertThrows(SensorException.NotTaken::class.java) { runBlocking { inbox.each { got += it.timeNs } } }
        assertEquals(listOf(1L, 2L, 3L), got)
    }

    @Test
    fun `a thread that delivers to nobody else waits for room, and no longer than anybody collects`() {
        val inbox = Inbox(most = 3)
        val given = AtomicInteger()
        val source = thread { runCatching { for (k in 1L..100) inbox.put(k).also { given.incrementAndGet() } } }
        val got = mutableListOf<Long>()
        assertThrows(EndOfTest::class.java) {
            runBlocking { inbox.each { got += it.timeNs; if (got.size == 10) throw EndOfTest() } }
        }
        assertEquals((1L..10).toList(), got)
        inbox.cancel()
        source.join()
        assertTrue(given.get() in 10..14, "$given")
    }
}
