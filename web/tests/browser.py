"""Chromium without a window, told what to do through two pipes (its DevTools protocol)."""

import base64
import json
import os
import shutil
import subprocess
import tempfile


class Browser:
    """One page in a Chromium of its own."""

    def __init__(self):
        to_read, self.to = os.pipe()
        self.back, to_write = os.pipe()
        self.folder = tempfile.mkdtemp()
        # Chromium reads from 3 and writes to 4
        script = 'exec "$0" "$@" 3<&%d 4>&%d' % (to_read, to_write)
        flags = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run", "--hide-scrollbars"]
        flags += ["--remote-debugging-pipe", f"--user-data-dir={self.folder}"]
        self.process = subprocess.Popen(
            ["bash", "-c", script, "chromium", *flags, "about:blank"],
            pass_fds=(to_read, to_write),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(to_read)
        os.close(to_write)
        self.number, self.text, self.session, self.events = 0, b"", None, []
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Network", "DOM", "Log"):
            self.call(f"{domain}.enable")

    def close(self):
        self.process.terminate()
        self.process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)

    def message(self):
        while b"\0" not in self.text:
            part = os.read(self.back, 1 << 20)
            assert part, "Chromium ended"
            self.text += part
        one, self.text = self.text.split(b"\0", 1)
        return json.loads(one)

    def call(self, method, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if self.session is not None:
            message["sessionId"] = self.session
        os.write(self.to, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.message()
            if answer.get("id") == self.number:
                assert "error" not in answer, f"{method}: {answer}"
                return answer["result"]
            self.events.append(answer)

    def run(self, script):
        """What a script in the page answers; a promise is awaited."""
        answer = self.call("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in answer, answer["exceptionDetails"]
        return answer["result"].get("value")

    def until(self, condition):
        """Waits in the page, without an end: whoever calls has a limit."""
        self.run(f"new Promise((done) => {{ const look = () => {condition} ? done(true) : setTimeout(look, 20); look(); }})")

    def open(self, url, width=1200, dark=False):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=800, deviceScaleFactor=1, mobile=False)
        scheme = "dark" if dark else "light"
        self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
        self.call("Page.navigate", url=url)
        self.until("document.readyState === 'complete' && document.getElementById('files') !== null")

    def give(self, *paths):
        """Chooses files, as a user does."""
        found = self.call("Runtime.evaluate", expression="document.getElementById('files')")["result"]
        self.call("DOM.setFileInputFiles", objectId=found["objectId"], files=[str(path) for path in paths])

    def picture(self, path, height):
        clip = {"x": 0, "y": 0, "width": self.run("innerWidth"), "height": height, "scale": 1}
        shot = self.call("Page.captureScreenshot", clip=clip, captureBeyondViewport=True)
        path.write_bytes(base64.b64decode(shot["data"]))

    def asked_for(self):
        """Every address that was asked for."""
        sent = (event for event in self.events if event.get("method") == "Network.requestWillBeSent")
        return [event["params"]["request"]["url"] for event in sent]

    def complaints(self):
        """Errors and refusals that the page's console tells."""
        found = [event["params"]["entry"]["text"] for event in self.events if event.get("method") == "Log.entryAdded"]
        return found + [str(event["params"]) for event in self.events if event.get("method") == "Runtime.exceptionThrown"]
