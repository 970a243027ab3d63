#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Opens a page in headless Chromium and performs steps on it.

    browse.py FILE|URL [--no-webgl] STEP...

A step is `return ...` or other JavaScript, whose value is printed as a line of JSON; `await CONDITION`, which waits until that
JavaScript is true; `key NAME`, which presses a key (ARROW_LEFT); `picture FILE`, a screenshot of the whole page; `view FILE`, of the
window; `size W H` of the window; `reload`; `open URL`; `shell COMMAND`;
`devtools METHOD ARGUMENTS`, JSON, a command of Chromium's DevTools protocol.
The last line lists the messages of the console at level SEVERE. The exit status is 0 unless a step fails.
"""

import json
import os
import pathlib
import subprocess
import sys
import tempfile

from selenium import webdriver
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.support.ui import WebDriverWait

PATIENCE = 120  # seconds, for machines that run many tests


def open_browser(profile, webgl):
    options = webdriver.ChromeOptions()
    options.binary_location = "/usr/bin/chromium"
    # The last flags keep the browser from contacting its maker's servers.
    for flag in ("--headless=new", "--no-sandbox", "--no-first-run", "--disable-background-networking", "--disable-component-update",
                 "--disable-sync", "--disable-quic", "--disable-dev-shm-usage", "--window-size=1400,1000",
                 f"--user-data-dir={profile}"):
        options.add_argument(flag)
    if webgl:
        options.add_argument("--enable-unsafe-swiftshader")  # WebGL in software, on any machine
    else:
        options.add_argument("--disable-3d-apis")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)


def picture(browser, file):
    width = browser.execute_script("return document.documentElement.clientWidth")
    height = browser.execute_script("return document.documentElement.scrollHeight")
    browser.set_window_size(width, height + 100)
    browser.execute_script("return new Promise((done) => setTimeout(done, 1000))")  # plots adapt with a delay
    pathlib.Path(file).write_bytes(browser.get_screenshot_as_png())


def perform(browser, step):
    word, _, rest = step.partition(" ")
    if word == "await":
        WebDriverWait(browser, PATIENCE, 0.05).until(lambda b: b.execute_script("return Boolean(" + rest + ")"))
    elif word == "key":
        browser.find_element(By.TAG_NAME, "body").send_keys(getattr(Keys, rest))
    elif word == "picture":
        picture(browser, rest)
    elif word == "view":
        pathlib.Path(rest).write_bytes(browser.get_screenshot_as_png())
    elif word == "shell":
        subprocess.run(rest, shell=True, check=True, stdout=subprocess.DEVNULL)
    elif word == "open":
        browser.get(rest)
    elif word == "size":
        browser.set_window_size(*map(int, rest.split()))
    elif step == "reload":
        browser.refresh()
    elif word == "devtools":
        method, _, arguments = rest.partition(" ")
        browser.execute_cdp_cmd(method, json.loads(arguments))
    else:
        print(json.dumps(browser.execute_script(step)))


def main():
    arguments = sys.argv[1:]
    webgl = "--no-webgl" not in arguments
    page, *steps = [one for one in arguments if one != "--no-webgl"]
    os.environ.setdefault("HOME", tempfile.gettempdir())  # Chromium needs a writable home
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        browser = open_browser(profile, webgl)
        browser.set_script_timeout(PATIENCE)  # a step may draw in software
        try:
            browser.get(page if page.startswith("http://") else pathlib.Path(page).absolute().as_uri())
            for step in steps:
                perform(browser, step)
            print(json.dumps([entry["message"] for entry in browser.get_log("browser") if entry["level"] == "SEVERE"]))
        finally:
            browser.quit()


if __name__ == "__main__":
    main()
