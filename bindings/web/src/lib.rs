//! The engine of a live page: questions as JSON in, answers as bytes out, through one piece of memory.
//!
//! The page reserves a place for its question, writes it there, asks, and reads the answer from where it stands until it asks
//! again. Nothing is imported. A fault of the engine is a trap; the page then begins with a new instance.
//!
//! The symbols are named apart from Rust's own, which the lint for unsafe code counts as unsafe; there is no other.

use mechanim::page::live::PageScenes;
use std::cell::RefCell;

/// What is kept between two calls. The page has one thread.
#[derive(Default)]
struct Engine {
    scenes: PageScenes,
    question: Vec<u8>,
    answer: Vec<u8>,
}

thread_local! {
    static ENGINE: RefCell<Engine> = RefCell::default();
}

/// Tells the program which version a file is of.
#[unsafe(no_mangle)]
pub static MECHANIM_WEB: &str = mechanim::page::live::STAMP;

/// A place for a question of so many bytes of UTF-8.
#[unsafe(no_mangle)]
pub extern "C" fn reserve(length: usize) -> *mut u8 {
    ENGINE.with_borrow_mut(|engine| {
        engine.question = vec![0; length];
        engine.question.as_mut_ptr()
    })
}

/// Answers the question that was written; the number of bytes of the answer.
#[unsafe(no_mangle)]
pub extern "C" fn ask() -> usize {
    ENGINE.with_borrow_mut(|engine| {
        let question = std::mem::take(&mut engine.question);
        engine.answer = engine.scenes.answer(&String::from_utf8_lossy(&question));
        engine.answer.len()
    })
}

/// Where the answer stands, until the next question.
#[unsafe(no_mangle)]
pub extern "C" fn answer() -> *const u8 {
    ENGINE.with_borrow(|engine| engine.answer.as_ptr())
}
