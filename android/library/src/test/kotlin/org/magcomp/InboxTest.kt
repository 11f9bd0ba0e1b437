package org.magcomp

import java.util.IdentityHashMap
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.cancelAndJoin
import kotlinx.coroutines.launch
import kotlinx.coroutines.runBlocking
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test

class InboxTest {
    private val objects = IdentityHashMap<RawEvent, Unit>()
    private val got = mutableListOf<String>()

    /** Who waits is woken within `put`. */
    private fun with(inbox: Inbox, events: (Inbox) -> Unit) = runBlocking {
        val taking = launch(Dispatchers.Unconfined) {
            inbox.takeAll {
                objects[it] = Unit
                got += "${it.kind} ${it.timeNs} ${it.x} ${it.y} ${it.z} ${it.reported?.x}"
            }
        }
        events(inbox)
        taking.cancelAndJoin()
    }

    @Test
    fun `an eager one wakes its collector with every event`() = with(Inbox(0.0, isEager = true)) { inbox ->
        inbox.put(RawEvent.ROTATION_RATE, 1, 1.0, 2.0, 3.0)
        assertEquals(listOf("0 1 1.0 2.0 3.0 null"), got)
        inbox.put(RawEvent.UP, 2, 4.0, 5.0, 6.0)
        inbox.put(RawEvent.MAGNETIC, 2, 7.0, 8.0, 9.0, DeviceVector(10.0, 0.0, 0.0))
        assertEquals(listOf("1 2 4.0 5.0 6.0 null", "2 2 7.0 8.0 9.0 10.0"), got.drop(1))
    }

    @Test
    fun `another one wakes it with the magnetometer's alone, or when 64 wait`() = with(Inbox(0.0, isEager = false)) { inbox ->
        for (k in 1L..63) inbox.put(RawEvent.ROTATION_RATE, k, 0.0, 0.0, 0.0)
        assertEquals(0, got.size)
        inbox.put(RawEvent.ROTATION_RATE, 64, 0.0, 0.0, 0.0)
        assertEquals(64, got.size)
        inbox.put(RawEvent.UP, 65, 0.0, 0.0, 0.0)
        assertEquals(64, got.size)
        inbox.put(RawEvent.MAGNETIC, 65, 0.0, 0.0, 0.0)
        assertEquals((1..65).map { "$it" } + "65", got.map { it.split(" ")[1] })
    }

    @Test
    fun `events come in the order of their times, and an object is used again`() = with(Inbox(0.05, isEager = false)) { inbox ->
        for (k in 1L..1000) {
            inbox.put(RawEvent.MAGNETIC, k * STEP_NS, 0.0, 0.0, 0.0)
            inbox.put(RawEvent.UP, k * STEP_NS, 0.0, 0.0, 0.0)
            inbox.put(RawEvent.ROTATION_RATE, k * STEP_NS, 0.0, 0.0, 0.0)
        }
        assertEquals((1L..1000).flatMap { k -> (0..2).map { "$it ${k * STEP_NS} 0.0 0.0 0.0 null" } }.take(got.size), got)
        assertTrue(got.size > 2900, "${got.size}")
        assertTrue(objects.size < 30, "${objects.size} objects")
    }

    @Test
    fun `what comes before the collector waits, whatever it is`() = runBlocking {
        val inbox = Inbox(0.0, isEager = false)
        for (k in 1L..5000) inbox.put(RawEvent.MAGNETIC, k, 0.0, 0.0, 0.0)
        with(inbox) {}
        assertEquals(5000, got.size)
    }
}
