package org.magcomp

import java.util.concurrent.atomic.AtomicInteger
import kotlin.concurrent.thread
import kotlinx.coroutines.ExperimentalCoroutinesApi
import kotlinx.coroutines.awaitCancellation
import kotlinx.coroutines.launch
import kotlinx.coroutines.runBlocking
import kotlinx.coroutines.test.TestScope
import kotlinx.coroutines.test.runCurrent
import kotlinx.coroutines.test.runTest
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertThrows
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

@OptIn(ExperimentalCoroutinesApi::class) // the clock of a test
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
        for (k in 1L..3) inbox.put(k)
        val error = assertThrows(SensorException.NotTaken::class.java) { Handover.delivering { inbox.put(4) } }
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

    /** What a collector leaves that is done with two events and is cancelled after [then]. */
    private fun left(then: TestScope.(Inbox) -> Unit): List<Long> {
        val inbox = Inbox(most = 10)
        runTest {
            val collecting = launch { inbox.each { if (it.timeNs > 2) awaitCancellation() } }
            for (k in 1L..2) inbox.put(k)
            runCurrent()
            then(inbox)
            collecting.cancel()
        }
        return buildList { inbox.rest { add(it.timeNs) } }
    }

    @Test
    fun `a cancelled collector leaves what it had in hand or on its way and what waits, and nothing that it is done with`() {
        assertEquals(emptyList<Long>(), left { })
        assertEquals(listOf(3L, 4L), left { inbox -> for (k in 3L..4) inbox.put(k) }, "on its way")
        assertEquals(listOf(3L, 4L), left { inbox -> for (k in 3L..4) inbox.put(k); runCurrent() }, "in hand")
    }
}
