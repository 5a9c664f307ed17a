"""A Chromium without a display, driven through its debugging pipe (https://chromedevtools.github.io/devtools-protocol). Standard library only."""

import json
import os
import select
import shutil
import subprocess
import tempfile
import time


class Browser:
    """One browser with one page. Commands block until they are answered; `errors` has what scripts did not catch and wrote to the console."""

    def __init__(self, program):
        self.profile = tempfile.mkdtemp(prefix="g3r_web_")
        self.downloads = os.path.join(self.profile, "downloads")
        os.mkdir(self.downloads)
        read_commands, self.commands = os.pipe()
        self.answers, write_answers = os.pipe()
        # Chromium reads commands from file 3 and writes answers to file 4.
        script = 'exec "$0" "$@" 3<&%d 4>&%d' % (read_commands, write_answers)
        options = ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--use-gl=angle", "--use-angle=swiftshader",
                   "--enable-unsafe-swiftshader", "--window-size=1200,760", "--remote-debugging-pipe", "--user-data-dir=" + self.profile]
        self.log = open(os.path.join(self.profile, "log"), "wb")
        self.process = subprocess.Popen(["sh", "-c", script, program, *options, "about:blank"], pass_fds=(read_commands, write_answers),
                                        stdout=self.log, stderr=self.log)
        os.close(read_commands)
        os.close(write_answers)
        self.buffer = b""
        self.number = 0
        self.sessions = {}  # of the page ("page"), its frame ("iframe") and its worker ("worker"): the latest
        self.errors = []
        pages = [t for t in self.command("Target.getTargets")["targetInfos"] if t["type"] == "page"]
        self.sessions["page"] = self.command("Target.attachToTarget", targetId=pages[0]["targetId"], flatten=True)["sessionId"]
        self.on("page", "Target.setAutoAttach", autoAttach=True, waitForDebuggerOnStart=False, flatten=True)
        for domain in ["Page", "Runtime", "DOM", "Log"]:
            self.on("page", domain + ".enable")
        self.command("Browser.setDownloadBehavior", behavior="allow", downloadPath=self.downloads)

    def close(self):
        try:
            self.command("Browser.close")
            self.process.wait(10)
        except (OSError, RuntimeError, subprocess.TimeoutExpired):
            self.process.kill()
            self.process.wait()
        self.log.close()
        shutil.rmtree(self.profile, ignore_errors=True)

    def _message(self, deadline):
        while b"\0" not in self.buffer:
            left = deadline - time.monotonic()
            if left <= 0 or not select.select([self.answers], [], [], left)[0]:
                raise RuntimeError("the browser does not answer")
            block = os.read(self.answers, 1 << 16)
            if not block:
                raise RuntimeError("the browser has ended")
            self.buffer += block
        text, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(text)

    def _note(self, event):
        method, values = event.get("method"), event.get("params", {})
        if method == "Target.attachedToTarget":
            self.sessions[values["targetInfo"]["type"]] = values["sessionId"]
        elif method == "Runtime.exceptionThrown":
            self.errors.append(values["exceptionDetails"].get("exception", {}).get("description", "?"))
        elif method == "Log.entryAdded" and values["entry"]["level"] == "error":
            self.errors.append(values["entry"]["text"])

    def command(self, method, session=None, seconds=600, **values):
        self.number += 1
        message = {"id": self.number, "method": method, "params": values}
        if session:
            message["sessionId"] = session
        os.write(self.commands, json.dumps(message).encode() + b"\0")
        deadline = time.monotonic() + seconds
        while True:
            answer = self._message(deadline)
            if answer.get("id") != self.number:
                self._note(answer)
                continue
            if "error" in answer:
                raise RuntimeError("%s: %s" % (method, answer["error"]["message"]))
            return answer["result"]

    def on(self, place, method, **values):
        return self.command(method, self.sessions[place], **values)

    def value(self, script, place="page"):
        """What the script, an expression, gives there; a promise is waited for."""
        result = self.on(place, "Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in result:
            raise RuntimeError(result["exceptionDetails"].get("exception", {}).get("description", "?"))
        return result["result"].get("value")

    def processor_seconds(self):
        """Of all its processes that run pages."""
        processes = self.command("SystemInfo.getProcessInfo")["processInfo"]
        return sum(p["cpuTime"] for p in processes if p["type"] == "renderer")

    def wait(self, script, seconds=300, place="page"):
        """Until the script gives what is true."""
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline:
            value = self.value(script, place)
            if value:
                return value
            time.sleep(0.05)
        raise RuntimeError("waited in vain for " + script)

    def drop(self, path):
        """Drops a file onto the page, as from a file manager."""
        data = {"items": [], "files": [path], "dragOperationsMask": 1}
        for kind in ["dragEnter", "dragOver", "drop"]:
            self.on("page", "Input.dispatchDragEvent", type=kind, x=400, y=300, data=data)

    def download(self, script, name, seconds=120):
        """The bytes of the file of that name that the script makes the page save."""
        path = os.path.join(self.downloads, name)
        if os.path.exists(path):
            os.remove(path)
        self.value(script)
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline:
            self.value("0")  # lets the browser speak
            if os.path.exists(path) and not os.path.exists(path + ".crdownload"):
                with open(path, "rb") as file:
                    return file.read()
            time.sleep(0.05)
        raise RuntimeError(name + " was not saved")
