O1200 (SUMS OF I, OF I J, OF I J K, EACH FROM 1 TO 12, 9 AND 5)
#1 = 1
WHILE [#1 LE 12] DO1
  #2 = 1
  WHILE [#2 LE 9] DO2
    #3 = 1
    WHILE [#3 LE 5] DO3
      #502 = #502 + #1 * #2 * #3
      #3 = #3 + 1
    END3
    #501 = #501 + #1 * #2
    #2 = #2 + 1
  END2
  #500 = #500 + #1
  #1 = #1 + 1
END1
M30
