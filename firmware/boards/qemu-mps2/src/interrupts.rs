//! The interrupt lines of the board that an image may use; the others end in `DefaultHandler`.

/// Lines by their number.
#[derive(Clone, Copy, Debug)]
#[repr(u16)]
pub enum Interrupt {
    /// CMSDK timer 0.
    Timer0 = 8,
}

// SAFETY: the numbers are those of the board's vector table, and no two are the same.
unsafe impl cortex_m::interrupt::InterruptNumber for Interrupt {
    fn number(self) -> u16 {
        self as u16
    }
}

/// An entry of the vector table.
#[derive(Clone, Copy)]
pub union Vector {
    handler: unsafe extern "C" fn(),
    _reserved: usize,
}

unsafe extern "C" {
    fn TIMER0();
    fn DefaultHandler();
}

/// Lines 0 to 15; the board has more, which nothing enables.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
pub static __INTERRUPTS: [Vector; 16] = {
    let mut table = [Vector { handler: DefaultHandler }; 16];
    table[Interrupt::Timer0 as usize] = Vector { handler: TIMER0 };
    table
};
