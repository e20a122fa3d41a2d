//! Just enough of a WebDriver client to drive Chromium: <https://www.w3.org/TR/webdriver2/>.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// How long anything may take before it has failed. Generous: machines that test are busy.
const PATIENCE: Duration = Duration::from_secs(120);

/// A running, headless Chromium; ends with this.
pub struct Browser {
    driver: Child,
    port: u16,
    session: String,
}

impl Browser {
    /// A browser with a window of that size, or why there is none.
    pub fn start(width: u32, height: u32) -> Result<Browser, String> {
        let mut driver = Command::new("chromedriver")
            .arg("--port=0")
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .map_err(|error| format!("chromedriver cannot be started: {error}"))?;
        let lines = BufReader::new(driver.stdout.take().expect("a pipe")).lines();
        let port = lines.map_while(Result::ok).find_map(|line| {
            line.rsplit_once("successfully on port ")?
                .1
                .trim_end_matches('.')
                .parse()
                .ok()
        });
        let mut browser = Browser {
            driver,
            port: port.unwrap_or(0),
            session: String::new(),
        };
        if port.is_none() {
            return Err("chromedriver does not say its port".to_owned());
        }
        let session = browser.request(
            "POST",
            "/session",
            &json!({ "capabilities": { "alwaysMatch": {
                "goog:chromeOptions": { "args": [
                    "--headless=new",
                    // As root, as in containers, there is no sandbox; the only page is ours.
                    "--no-sandbox",
                    "--disable-dev-shm-usage",
                    "--force-device-scale-factor=1",
                    format!("--window-size={width},{height}"),
                ] },
                "goog:loggingPrefs": { "browser": "ALL", "performance": "ALL" },
            } } }),
        )?;
        browser.session = format!(
            "/session/{}",
            session["sessionId"].as_str().unwrap_or_default()
        );
        Ok(browser)
    }

    fn request(&self, method: &str, path: &str, body: &Value) -> Result<Value, String> {
        self.exchange(method, path, &body.to_string())
            .map_err(|error| format!("{path}: {error}"))
    }

    fn exchange(&self, method: &str, path: &str, body: &str) -> Result<Value, String> {
        let text = |error: std::io::Error| error.to_string();
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).map_err(text)?;
        stream.set_read_timeout(Some(PATIENCE)).map_err(text)?;
        let length = body.len();
        write!(
            stream,
            "{method} {path} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\
             Content-Type: application/json\r\nContent-Length: {length}\r\n\r\n{body}"
        )
        .map_err(text)?;
        let mut reader = BufReader::new(stream);
        let mut length = 0;
        loop {
            let mut line = String::new();
            reader.read_line(&mut line).map_err(text)?;
            match line.trim_end().to_ascii_lowercase().split_once(':') {
                Some(("content-length", value)) => length = value.trim().parse().unwrap_or(0),
                _ if line.trim_end().is_empty() => break,
                _ => {}
            }
        }
        let mut answer = vec![0; length];
        reader.read_exact(&mut answer).map_err(text)?;
        let answer: Value = serde_json::from_slice(&answer).map_err(|error| error.to_string())?;
        match &answer["value"]["error"] {
            Value::String(error) => Err(format!("{error}: {}", answer["value"]["message"])),
            _ => Ok(answer["value"].clone()),
        }
    }

    fn command(&self, path: &str, body: Value) -> Value {
        let path = format!("{}/{path}", self.session);
        self.request("POST", &path, &body).unwrap()
    }

    pub fn open(&self, url: &str) {
        self.command("url", json!({ "url": url }));
    }

    /// What the body of a function returns.
    pub fn run(&self, script: &str) -> Value {
        self.command("execute/sync", json!({ "script": script, "args": [] }))
    }

    /// Returns when the expression holds.
    pub fn wait_for(&self, expression: &str) {
        let start = Instant::now();
        while self.run(&format!("return Boolean({expression})")) != true {
            assert!(
                start.elapsed() < PATIENCE,
                "waited in vain for {expression}"
            );
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Presses and releases key by key. Special keys have codes: section 17.4.2 of the standard.
    pub fn press(&self, keys: &str) {
        let actions: Vec<_> = keys
            .chars()
            .flat_map(|key| {
                let key = key.to_string();
                [
                    json!({ "type": "keyDown", "value": &key }),
                    json!({ "type": "keyUp", "value": &key }),
                ]
            })
            .collect();
        let source = json!({ "type": "key", "id": "keyboard", "actions": actions });
        self.command("actions", json!({ "actions": [source] }));
    }

    /// Moves the pointer to a place in the window.
    pub fn point(&self, [x, y]: [i64; 2]) {
        self.pointer(json!([{ "type": "pointerMove", "x": x, "y": y }]));
    }

    /// Presses the button at one place and releases it at another.
    pub fn drag(&self, [from_x, from_y]: [i64; 2], [x, y]: [i64; 2]) {
        self.pointer(json!([
            { "type": "pointerMove", "x": from_x, "y": from_y },
            { "type": "pointerDown", "button": 0 },
            { "type": "pointerMove", "x": x, "y": y, "duration": 50 },
            { "type": "pointerUp", "button": 0 },
        ]));
    }

    fn pointer(&self, actions: Value) {
        let source = json!({ "type": "pointer", "id": "mouse", "actions": actions });
        self.command("actions", json!({ "actions": [source] }));
    }

    /// What was written to the console since this was last asked.
    pub fn console(&self) -> Vec<String> {
        let entries = self.log("browser");
        entries
            .iter()
            .map(|entry| entry["message"].to_string())
            .collect()
    }

    /// The addresses of everything that was asked for since this was last asked.
    pub fn requests(&self) -> Vec<String> {
        let events = self.log("performance").into_iter().filter_map(|entry| {
            let event: Value = serde_json::from_str(entry["message"].as_str()?).ok()?;
            let message = &event["message"];
            let is_request = message["method"] == "Network.requestWillBeSent";
            let url = message["params"]["request"]["url"].as_str()?;
            is_request.then(|| url.to_owned())
        });
        events.collect()
    }

    fn log(&self, kind: &str) -> Vec<Value> {
        let entries = self.command("se/log", json!({ "type": kind }));
        entries.as_array().unwrap().clone()
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // Ends Chromium, then the driver; if the driver is gone, so is Chromium.
        if !self.session.is_empty() {
            let _ = self.exchange("DELETE", &self.session, "");
        }
        let _ = self.driver.kill();
        let _ = self.driver.wait();
    }
}
